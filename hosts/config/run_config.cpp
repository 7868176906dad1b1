#include "hosts/config/run_config.hpp"

#include "engine/core/error.hpp"

namespace posefusion {

SlamConfig slam_config(const RunConfig& config) {
    SlamConfig slam = config.slam;
    slam.loops.enabled = slam.loops.enabled && !config.no_loops;
    slam.localise_only = config.localise_only;
    return slam;
}

void check_config(const RunConfig& config) {
    if (config.out.empty()) throw Error("--out is empty; give a folder for the results");
    if (config.no_people && !config.masks.empty()) {
        throw Error("--no-people and --masks exclude each other; give one of them");
    }
    if (!config.mask_network.empty() && (config.no_people || !config.masks.empty())) {
        throw Error("--mask-network excludes --no-people and --masks; give one of them");
    }
    if (!config.classes.empty() && config.masks.empty() && config.mask_network.empty()) {
        throw Error("--classes needs --masks or --mask-network; give one of them");
    }
    if (config.objects && config.no_motion) {
        throw Error("--objects and --no-motion exclude each other: nothing but people is looked for");
    }
    if (config.real_time && (config.checkpoint_every > 0 || config.resume)) {
        throw Error("--real-time excludes --checkpoint-every and --resume: each run drops other frames");
    }
    if (config.localise_only && config.load_map.empty()) {
        throw Error("--localise-only needs a map to localise in; give one with --load-map");
    }
    if (!config.load_map.empty() && !config.slam.relocalisation.enabled) {
        throw Error("--load-map needs relocalisation.enabled, or the camera is never found in the map");
    }
    const PreprocessConfig& preprocess = config.slam.preprocess;
    if (preprocess.depth_min >= preprocess.depth_max) {
        throw Error("preprocess.depth_min must be less than preprocess.depth_max, or no depth is left");
    }
    const TrackingConfig& tracking = config.slam.tracking;
    if (!tracking.icp && !tracking.photometric) {
        throw Error("tracking.icp and tracking.photometric are both off; the camera cannot be tracked without either");
    }
    if (tracking.iterations[0] + tracking.iterations[1] + tracking.iterations[2] == 0) {
        throw Error("tracking.iterations are all 0; the camera cannot be tracked without a step");
    }
}

}  // namespace posefusion
