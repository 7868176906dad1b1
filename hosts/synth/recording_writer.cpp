#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/synth/sensor_unit.hpp"
#include "hosts/synth/synth.hpp"

/// The sequence as files, in the layout of the TUM RGB-D benchmark.
namespace posefusion {
namespace {

using namespace synth;

constexpr int kJpegQuality = 95;

class SequenceWriter {
public:
    SequenceWriter(const std::filesystem::path& folder, const SynthWorld& world)
        : folder_(prepared(folder)),
          lock_(folder),
          color_(folder / "rgb.txt", title("color images")),
          depth_(folder / "depth.txt", title("depth maps")),
          masks_(folder / "masks.txt", title(world.objects().empty() ? "person labels (0 static, 1..n person)"
                                                                     : "labels (0 static, 1..n person, 101.. object)")),
          pairs_(folder / "associations.txt"),
          world_(world),
          object_trajectories_(world.objects().size()) {
        if (perfect()) {
            write_file_atomically(folder_ / "camera.yaml", camera_file());
        } else {
            write_camera_file(folder_ / "camera.yaml", world.sensor().calibration());
            write_camera_file(folder_ / "camera_true.yaml", world.sensor().camera());
        }
    }
    ~SequenceWriter() {
        if (!stamps_.empty()) return;
        std::error_code ignored;  // nothing was made: the folder may be used again
        for (const char* file :
             {"rgb.txt", "depth.txt", "masks.txt", "associations.txt", "camera.yaml", "camera_true.yaml"})
            std::filesystem::remove(folder_ / file, ignored);
    }
    SequenceWriter(const SequenceWriter&) = delete;
    SequenceWriter& operator=(const SequenceWriter&) = delete;

    void add(const SynthFrame& frame) {
        const std::string stamp = fixed_text(frame.stamp, 6), depth_stamp = fixed_text(frame.depth_stamp, 6);
        const std::string color = "rgb/" + stamp + ".jpg", depth = "depth/" + depth_stamp + ".png";
        const std::string mask = "masks/" + stamp + ".png";
        write_jpeg(folder_ / color, frame.color, kJpegQuality);
        write_depth(folder_ / depth, frame.depth, kSynthDepthScale);
        write_labels(folder_ / mask, frame.labels);
        color_.append(stamp + " " + color + "\n");
        depth_.append(depth_stamp + " " + depth + "\n");
        masks_.append(stamp + " " + mask + "\n");
        pairs_.append(stamp + " " + color + " " + depth_stamp + " " + depth + "\n");
        stamps_.push_back(stamp);
        trajectory_.push_back({parse_stamp(stamp).value(), frame.T_world_camera});
        for (std::size_t i = 0; i < object_trajectories_.size(); ++i)
            object_trajectories_[i].push_back({trajectory_.back().stamp, frame.T_world_object[i]});
        joints_.push_back(joints(stamp, depth_stamp, frame));
        gains_.push_back({frame.gain.x(), frame.gain.y(), frame.gain.z()});
    }

    /// What belongs to the frames. It is small: on a disk that is full it still fits where the frame did not.
    void finish() const {
        write_trajectory(folder_ / "groundtruth.txt", trajectory_);
        for (std::size_t i = 0; i < object_trajectories_.size(); ++i) write_object_trajectory(i);
        write_file_atomically(folder_ / "info.json", info_file().dump(1) + "\n");
        write_file_atomically(folder_ / "events.json", events_file().dump(1) + "\n");
        write_file_atomically(folder_ / "joints.json", joints_file().dump() + "\n");
    }

    void add_surfaces() const {
        write_surface(folder_ / "surface.ply", world_.room());
        for (const SynthObject& object : world_.objects())
            write_surface(folder_ / object_folder(object) / "mesh.ply", object.surface);
    }

    [[nodiscard]] int frames() const { return static_cast<int>(stamps_.size()); }

private:
    static std::string object_folder(const SynthObject& object) {
        return "objects/" + (object.label > 0 ? std::to_string(object.label) : std::string("screen"));
    }
    static void write_surface(const std::filesystem::path& file, const SynthTriangles& surface) {
        constexpr Rgb8 kGrey{190, 190, 190};
        Mesh mesh;
        for (const Eigen::Vector3f& p : surface.vertices) mesh.vertices.push_back({p, kGrey});
        mesh.faces = surface.faces;
        write_mesh(file, mesh);
    }
    void write_object_trajectory(std::size_t index) const {
        const std::filesystem::path own = folder_ / object_folder(world_.objects()[index]);
        prepare_output_folder(own);
        write_trajectory(own / "groundtruth.txt", object_trajectories_[index]);
    }
    static nlohmann::ordered_json joints(const std::string& stamp, const std::string& depth_stamp,
                                         const SynthFrame& frame) {
        const auto rounded = [](float value, double steps) {
            return std::round(static_cast<double>(value) * steps) / steps;
        };
        nlohmann::ordered_json people = nlohmann::ordered_json::array();
        for (const SynthPerson& person : frame.people) {
            nlohmann::ordered_json points = nlohmann::ordered_json::array();
            for (const SynthJoint& j : person.joints)
                points.push_back(
                    {rounded(j.u, 100), rounded(j.v, 100), rounded(j.z, 10000), static_cast<int>(j.visibility)});
            people.push_back(
                {{"id", person.id}, {"pixels", person.pixels}, {"sitting", person.sitting}, {"joints", points}});
        }
        return {{"rgb", stamp}, {"depth", depth_stamp}, {"persons", people}};
    }
    [[nodiscard]] nlohmann::ordered_json joints_file() const {
        return {{"names",
                 {"nose", "neck", "r_shoulder", "r_elbow", "r_wrist", "l_shoulder", "l_elbow", "l_wrist", "r_hip",
                  "r_knee", "r_ankle", "l_hip", "l_knee", "l_ankle", "r_eye", "l_eye", "r_ear", "l_ear"}},
                {"joint",
                 {"u_px", "v_px", "z_m",
                  "visibility: 0 outside the image or hidden by something else, 1 hidden by the own body, 2 visible"}},
                {"frames", joints_}};
    }
    [[nodiscard]] std::string camera_file() const {
        const Intrinsics& c = world_.camera();
        return "# pinhole without distortion; the centre of the top left pixel is (0, 0)\n"
               "width: " +
               std::to_string(c.width) + "\nheight: " + std::to_string(c.height) + "\nfx: " + shortest_text(c.fx) +
               "\nfy: " + shortest_text(c.fy) + "\ncx: " + shortest_text(c.cx) + "\ncy: " + shortest_text(c.cy) +
               "\nfps: " + shortest_text(world_.config().fps) + "\ndepth_scale: " + shortest_text(kSynthDepthScale) +
               "\n";
    }
    [[nodiscard]] nlohmann::ordered_json info_file() const {
        const SynthConfig& c = world_.config();
        nlohmann::ordered_json info{{"source", "posefusion synth"},
                                    {"scenario", scenario_name(c.scenario)},
                                    {"frames", stamps_.size()},
                                    {"people", c.people},
                                    {"seed", c.seed},
                                    {"noise", c.noise},
                                    {"easy", c.easy},
                                    {"still_camera", c.still_camera},
                                    {"camera_speed", c.camera_speed}};
        if (!perfect()) info["sensor"] = sensor_truth();
        for (const SynthObject& object : world_.objects()) {
            const std::string own = object_folder(object);
            info["objects"].push_back({{"kind", object_name(object.kind)},
                                       {"label", object.label},
                                       {"rigid", true},
                                       {"trajectory", own + "/groundtruth.txt"},
                                       {"mesh", own + "/mesh.ply"}});
        }
        return info;
    }
    /// What the sensor truly does; the times are named like the options of a run that correct them.
    [[nodiscard]] nlohmann::ordered_json sensor_truth() const {
        const SensorUnit& unit = world_.sensor();
        const SensorModel& model = unit.model();
        const DepthDistortion& distortion = unit.depth_distortion();
        return {{"name", model.name},
                {"color_readout_ms", model.shutter.color_readout_ms},
                {"depth_readout_ms", model.shutter.depth_readout_ms},
                {"stamp_row", model.shutter.stamp_row},
                {"depth_delay_ms", model.shutter.depth_delay_ms},
                {"stamped_delay_ms", model.stamped_delay_ms},
                {"stamped_wander_ms", model.stamped_wander_ms},
                {"camera_true", camera_json(unit.camera())},
                {"camera_calibrated", camera_json(unit.calibration())},
                {"depth_distortion",
                 {{"corner_per_m", distortion.corner},
                  {"tilt_per_m", distortion.tilt},
                  {"still_radius2", distortion.still_radius2},
                  {"meaning",
                   "1 / measured = 1 / true - c, c = corner (r^2 - still_radius2) + tilt x; r = 1 in the corner, "
                   "x = 1 at the right edge, both 0 in the true principal point"}}},
                {"vignetting_ev", model.exposure.vignetting_ev},
                {"gains", gains_}};
    }
    static nlohmann::ordered_json camera_json(const Camera& camera) {
        const Intrinsics& k = camera.intrinsics;
        return {{"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}, {"lens", camera.distortion}};
    }
    [[nodiscard]] bool perfect() const { return world_.sensor().model().perfect(); }
    /// What happens when; frames that were not written because the sequence was stopped early are left out.
    [[nodiscard]] nlohmann::ordered_json events_file() const {
        const auto event = [&](int frame) -> nlohmann::ordered_json {
            const auto i = static_cast<std::size_t>(frame);
            if (i >= stamps_.size()) return nullptr;
            return {{"frame", frame}, {"stamp", stamps_[i]}};
        };
        nlohmann::ordered_json covered = nlohmann::ordered_json::array();
        for (const int frame : world_.events().covered)
            if (auto entry = event(frame); !entry.is_null()) covered.push_back(std::move(entry));
        const auto& revisit = world_.events().revisit_from;
        return {{"scenario", scenario_name(world_.config().scenario)},
                {"covered", covered},
                {"revisit_from", revisit ? event(*revisit) : nlohmann::ordered_json()}};
    }
    static std::filesystem::path prepared(const std::filesystem::path& folder) {
        expect_no_recording(folder);
        for (const char* part : {"rgb", "depth", "masks"}) prepare_output_folder(folder / part);
        return folder;
    }
    static std::string title(const std::string& content) {
        return "# " + content + "\n# made by posefusion synth\n# timestamp filename\n";
    }

    std::filesystem::path folder_;
    FolderLock lock_;
    GrowingFile color_, depth_, masks_, pairs_;
    const SynthWorld& world_;
    std::vector<std::string> stamps_;
    Trajectory trajectory_;
    std::vector<Trajectory> object_trajectories_;  // T_world_object
    nlohmann::ordered_json joints_ = nlohmann::ordered_json::array();
    nlohmann::ordered_json gains_ = nlohmann::ordered_json::array();  // of linear light per frame, RGB
};

}  // namespace

int synthesize(const SynthConfig& config, const SynthProgress& progress) {
    if (config.out.empty()) throw Error("synth: no output folder given, use --out DIR");
    const SynthWorld world(config);
    SequenceWriter writer(config.out, world);
    const auto kept = [&](const Error& error) {
        return Error(error.what() + std::string("; kept in ") + config.out.string() + ": " +
                     counted(writer.frames(), "frame"));
    };
    for (int i = 0; i < config.frames; ++i) {
        const SynthFrame frame = world.render(i);
        try {
            writer.add(frame);
        } catch (const Error& error) {
            if (writer.frames() == 0) throw;
            writer.finish();
            throw kept(error);
        }
        if (progress && !progress(writer.frames(), config.frames)) break;
    }
    writer.finish();
    try {
        writer.add_surfaces();
    } catch (const Error& error) {
        throw kept(error);
    }
    return writer.frames();
}

}  // namespace posefusion
