/// peer_odometry RECORDING: how long a peer needs for the same frames on one thread of the same processor. The peer is
/// OpenCV's RgbdICPOdometry (contrib module rgbd), frame to frame, with its defaults. Prints one line per frame:
/// milliseconds, preparing the new frame included, reading and decoding not.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>

#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"
#include "hosts/io/recording.hpp"

namespace {

using posefusion::Frame;

cv::Ptr<cv::rgbd::OdometryFrame> as_odometry_frame(const Frame& frame) {
    const cv::Mat color(frame.color.height(), frame.color.width(), CV_8UC3,
                        const_cast<posefusion::Rgb8*>(frame.color.data()));
    const cv::Mat depth(frame.depth.height(), frame.depth.width(), CV_32F, const_cast<float*>(frame.depth.data()));
    cv::Mat grey;
    cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
    return cv::rgbd::OdometryFrame::create(grey, depth.clone(), depth > 0);
}

void time_odometry(const posefusion::Recording& recording, std::size_t frames) {
    const posefusion::Intrinsics& c = recording.intrinsics();
    const cv::Matx33f K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    const auto odometry = cv::rgbd::RgbdICPOdometry::create();
    odometry->setCameraMatrix(cv::Mat(K));
    cv::Ptr<cv::rgbd::OdometryFrame> previous;
    for (std::size_t i = 0; i < std::min(frames, recording.size()); ++i) {
        const Frame frame = recording.load(i);
        cv::Mat T_previous_current;
        const posefusion::Stopwatch watch;
        auto current = as_odometry_frame(frame);
        if (previous) (void)odometry->compute(current, previous, T_previous_current);
        if (previous) std::printf("%.3f\n", watch.milliseconds());
        previous = current;
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times OpenCV's RgbdICPOdometry on a recording, one thread");
    std::string location;
    std::size_t frames = 60;
    posefusion::SourceOptions options;
    app.add_option("RECORDING", location, "anything that `posefusion run` reads")->required();
    app.add_option("--frames", frames, "number of frames, from the first")->capture_default_str();
    app.add_option("--scale", options.scale, "shrink the images to this share")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        cv::setNumThreads(1);
        time_odometry(posefusion::Recording(location, options), frames);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peer_odometry: %s\n", error.what());
        return 1;
    }
    return 0;
}
