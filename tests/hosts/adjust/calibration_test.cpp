#include "hosts/adjust/calibration.hpp"

#include <gtest/gtest.h>

#include "tests/hosts/adjust/synthetic_bundle.hpp"

namespace posefusion {
namespace {

CameraParameters wrong(CameraParameters camera) {
    camera(0) *= 1.006, camera(1) *= 1.006, camera(2) += 2.5, camera(3) -= 2;
    return camera;
}

TEST(Calibration, ARightOneStaysAsItIs) {
    const SyntheticBundle truth;
    const Calibration c = calibrate(truth.make(truth.camera));
    EXPECT_FALSE(c.found());
    EXPECT_EQ(c.believed, c.given);
}

TEST(Calibration, OnlyWhatIsWrongIsCorrected) {
    const SyntheticBundle truth;
    const Calibration intrinsics = calibrate(truth.make(wrong(truth.camera)));
    EXPECT_TRUE(intrinsics.intrinsics);
    EXPECT_FALSE(intrinsics.deformation);
    EXPECT_NEAR(intrinsics.believed(0), truth.camera(0), 0.001 * truth.camera(0));
    EXPECT_EQ(deformation_part(intrinsics.believed), deformation_part(truth.camera));

    SyntheticBundle deformed;
    deformed.camera = with_deformation(deformed.camera, 0.008);
    const Calibration deformation = calibrate(deformed.make(truth.camera));
    EXPECT_TRUE(deformation.deformation);
    EXPECT_FALSE(deformation.intrinsics);
    EXPECT_EQ(intrinsics_part(deformation.believed), intrinsics_part(truth.camera));
}

TEST(Calibration, ACameraThatHardlyMovesChangesNothing) {
    SyntheticBundle truth;
    truth.step = 0.01;
    EXPECT_FALSE(calibrate(truth.make(wrong(truth.camera))).found());
}

TEST(Calibration, ImagesThatNoCameraWouldSeeChangeNothing) {
    const SyntheticBundle truth;
    Bundle bundle = truth.make(truth.camera);
    // rows read one after another by a fast camera: other shifts in every image, growing with the row
    for (Observation& o : bundle.observations) o.pixel.x() += 0.02 * std::sin(2.0 * o.keyframe) * (o.pixel.y() - 240);
    EXPECT_FALSE(calibrate(bundle).found());
}

}  // namespace
}  // namespace posefusion
