// Camera trajectory of a recording, frame by frame: example RECORDING TRAJECTORY.txt
#include <cstdio>
#include <engine/core/error.hpp>
#include <hosts/io/recording.hpp>
#include <hosts/io/trajectory.hpp>
#include <hosts/library/version.hpp>
#include <hosts/pipeline/frame_by_frame.hpp>

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: %s RECORDING TRAJECTORY.txt\n", argv[0]);
        return 2;
    }
    try {
        const posefusion::Recording sequence(argv[1]);  // or take colour and depth from anywhere else

        posefusion::Camera camera;
        camera.intrinsics = sequence.intrinsics();
        posefusion::RunConfig config;
        config.slam.tracking.icp_max_distance = 0.08f;  // metres; every option of the command line has its field
        posefusion::FrameByFrame method(camera, config);

        for (std::size_t i = 0; i < sequence.size(); ++i) {
            posefusion::Frame frame = sequence.load(i);
            const auto result = method.process(frame.stamp, std::move(frame.color), std::move(frame.depth));
            const Eigen::Vector3d position = result.slam.T_world_camera.translation();
            std::printf("%zu  %.3f %.3f %.3f m  %d people  %u surfels\n", i, position.x(), position.y(), position.z(),
                        result.people.segmentation.people, result.slam.surfels);
        }
        posefusion::write_trajectory(argv[2], method.trajectory());
        std::printf("PoseFusion %s, %zu stable surfels\n", posefusion::version(), method.slam().surfels().size());
    } catch (const posefusion::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
