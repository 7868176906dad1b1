#pragma once
/// The library: #include <posefusion/posefusion.hpp>. What is installed is this, and what it includes; each header may
/// be included alone as well, as <posefusion/engine/slam/slam.hpp>.
///
///     posefusion::PoseFusion slam(camera);
///     slam.process(color, depth, stamp);
#include "engine/core/error.hpp"
#include "engine/slam/slam.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/library/version.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "pose/detector.hpp"
#include "segmentation/segmenter.hpp"
