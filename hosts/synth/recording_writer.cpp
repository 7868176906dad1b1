#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/synth/synth.hpp"

/// The sequence as files, in the layout of the TUM RGB-D benchmark.
namespace posefusion {
namespace {

constexpr float kDepthScale = 5000;  ///< units per metre
constexpr int kJpegQuality = 95;

class SequenceWriter {
public:
    explicit SequenceWriter(const std::filesystem::path& folder) : folder_(folder) {
        prepare_output_folder(folder_);
        for (const char* part : {"rgb", "depth", "masks"}) prepare_output_folder(folder_ / part);
    }

    void add(const SynthFrame& frame) {
        const std::string stamp = fixed_text(frame.stamp, 6);
        write_jpeg(folder_ / "rgb" / (stamp + ".jpg"), frame.color, kJpegQuality);
        write_depth(folder_ / "depth" / (stamp + ".png"), frame.depth, kDepthScale);
        write_labels(folder_ / "masks" / (stamp + ".png"), frame.labels);
        stamps_.push_back(stamp);
        trajectory_.push_back({parse_stamp(stamp).value(), frame.T_world_camera});
        joints_.push_back(joints(stamp, frame));
    }

    void finish(const SynthWorld& world) const {
        write_list("rgb.txt", "color images", "rgb", ".jpg");
        write_list("depth.txt", "depth maps", "depth", ".png");
        write_list("masks.txt", "person labels (0 static, 1..n person)", "masks", ".png");
        write_file_atomically(folder_ / "associations.txt", lines([](const std::string& s) {
                                  return s + " rgb/" + s + ".jpg " + s + " depth/" + s + ".png";
                              }));
        write_trajectory(folder_ / "groundtruth.txt", trajectory_);
        write_file_atomically(folder_ / "joints.json", joints_file().dump() + "\n");
        write_file_atomically(folder_ / "camera.yaml", camera_file(world));
        write_file_atomically(folder_ / "info.json", info_file(world).dump(1) + "\n");
        write_file_atomically(folder_ / "events.json", events_file(world).dump(1) + "\n");
    }

private:
    static nlohmann::ordered_json joints(const std::string& stamp, const SynthFrame& frame) {
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
        return {{"rgb", stamp}, {"depth", stamp}, {"persons", people}};
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
    static std::string camera_file(const SynthWorld& world) {
        const Intrinsics& c = world.camera();
        return "# pinhole without distortion; the centre of the top left pixel is (0, 0)\n"
               "width: " +
               std::to_string(c.width) + "\nheight: " + std::to_string(c.height) + "\nfx: " + shortest_text(c.fx) +
               "\nfy: " + shortest_text(c.fy) + "\ncx: " + shortest_text(c.cx) + "\ncy: " + shortest_text(c.cy) +
               "\nfps: " + shortest_text(world.config().fps) + "\ndepth_scale: " + shortest_text(kDepthScale) + "\n";
    }
    [[nodiscard]] nlohmann::ordered_json info_file(const SynthWorld& world) const {
        const SynthConfig& c = world.config();
        return {{"source", "posefusion synth"},
                {"scenario", scenario_name(c.scenario)},
                {"frames", stamps_.size()},
                {"people", c.people},
                {"seed", c.seed},
                {"noise", c.noise},
                {"easy", c.easy},
                {"still_camera", c.still_camera},
                {"camera_speed", c.camera_speed}};
    }
    /// What happens when; frames that were not written because the sequence was stopped early are left out.
    [[nodiscard]] nlohmann::ordered_json events_file(const SynthWorld& world) const {
        const auto event = [&](int frame) -> nlohmann::ordered_json {
            const auto i = static_cast<std::size_t>(frame);
            if (i >= stamps_.size()) return nullptr;
            return {{"frame", frame}, {"stamp", stamps_[i]}};
        };
        nlohmann::ordered_json covered = nlohmann::ordered_json::array();
        for (const int frame : world.events().covered)
            if (auto entry = event(frame); !entry.is_null()) covered.push_back(std::move(entry));
        const auto& revisit = world.events().revisit_from;
        return {{"scenario", scenario_name(world.config().scenario)},
                {"covered", covered},
                {"revisit_from", revisit ? event(*revisit) : nlohmann::ordered_json()}};
    }
    [[nodiscard]] std::string lines(const std::function<std::string(const std::string&)>& line) const {
        std::string all;
        for (const std::string& stamp : stamps_) all += line(stamp) + "\n";
        return all;
    }
    void write_list(const char* file, const char* title, const std::string& part, const std::string& extension) const {
        write_file_atomically(folder_ / file,
                              std::string("# ") + title + "\n# made by posefusion synth\n# timestamp filename\n" +
                                  lines([&](const std::string& s) { return s + " " + part + "/" + s + extension; }));
    }

    std::filesystem::path folder_;
    std::vector<std::string> stamps_;
    Trajectory trajectory_;
    nlohmann::ordered_json joints_ = nlohmann::ordered_json::array();
};

}  // namespace

void synthesize(const SynthConfig& config, const SynthProgress& progress) {
    if (config.out.empty()) throw Error("synth: no output folder given, use --out DIR");
    const SynthWorld world(config);
    SequenceWriter writer(config.out);
    for (int i = 0; i < config.frames; ++i) {
        writer.add(world.render(i));
        if (progress && !progress(i + 1, config.frames)) break;
    }
    writer.finish(world);
}

}  // namespace posefusion
