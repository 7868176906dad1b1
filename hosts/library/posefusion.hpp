#pragma once
/// The library: #include <posefusion/posefusion.hpp>. This header and those it includes are installed; each may also be
/// included alone, for example <posefusion/engine/slam/slam.hpp>.
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
