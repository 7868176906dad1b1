// Camera trajectory of a recording, frame by frame: example RECORDING TRAJECTORY.txt
#include <cstdio>
#include <posefusion/posefusion.hpp>

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: %s RECORDING TRAJECTORY.txt\n", argv[0]);
        return 2;
    }
    try {
        const posefusion::Recording recording(argv[1]);  // or take colour and depth from anywhere else

        posefusion::Camera camera;
        camera.intrinsics = recording.intrinsics();
        posefusion::RunConfig config;
        config.slam.tracking.icp_max_distance = 0.08f;  // metres; every option of the command line has its field
        posefusion::PoseFusion slam(camera, config);

        for (std::size_t i = 0; i < recording.size(); ++i) {
            posefusion::Frame input = recording.load(i);
            const auto frame = slam.process(std::move(input.color), std::move(input.depth), input.stamp);
            const Eigen::Vector3d position = frame.result.T_world_camera.translation();
            std::printf("%zu  %.3f %.3f %.3f m  %d people  %u surfels\n", i, position.x(), position.y(), position.z(),
                        frame.people.segmentation.people, frame.result.surfels);
        }
        posefusion::write_trajectory(argv[2], slam.trajectory());
        std::printf("PoseFusion %s, %zu stable surfels\n", posefusion::version(), slam.engine().surfels().size());
    } catch (const posefusion::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
