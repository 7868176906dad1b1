#include "hosts/export/view.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

Camera some_camera() { return {{500, 510, 320, 240, 640, 480}}; }

TEST(View, APointIsSeenWhereTheCameraProjectsIt) {
    const auto pixel = pixel_of({0.2f, -0.1f, 2}, some_camera());
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), 370, 1e-3);
    EXPECT_NEAR(pixel->y(), 214.5, 1e-3);
    EXPECT_FALSE(pixel_of({0.2f, -0.1f, -2}, some_camera())) << "behind the camera";
    EXPECT_FALSE(pixel_of({2, 0, 2}, some_camera())) << "beside the image";
}

TEST(View, TheLensMovesAPoint) {
    Camera camera = some_camera();
    camera.distortion = {-0.1f, 0.02f, 0.001f, -0.002f};
    const float x = 0.3f, y = -0.2f, r2 = x * x + y * y, radial = 1 - 0.1f * r2 + 0.02f * r2 * r2;
    const auto pixel = pixel_of({x, y, 1}, camera);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), 320 + 500 * (x * radial + 2 * 0.001f * x * y - 0.002f * (r2 + 2 * x * x)), 1e-2);
    EXPECT_NEAR(pixel->y(), 240 + 510 * (y * radial + 0.001f * (r2 + 2 * y * y) - 2 * 0.002f * x * y), 1e-2);
}

/// r (1 - r^2) comes back to the image centre at r = 1.
TEST(View, PointsFarOutsideDoNotFoldIntoTheImage) {
    Camera camera = some_camera();
    camera.distortion = {-1, 0};
    EXPECT_FALSE(pixel_of({1, 0, 1}, camera));
}

TEST(View, LabelsGrowByTheMarginInBothDirections) {
    LabelImage labels(12, 9);
    labels(4, 3) = 2;
    const LabelImage wide = grown(labels, 2);
    for (int v = 0; v < 9; ++v)
        for (int u = 0; u < 12; ++u) EXPECT_EQ(wide(u, v), std::abs(u - 4) <= 2 && std::abs(v - 3) <= 2 ? 2 : 0);
    EXPECT_EQ(grown(labels, 0)(4, 3), 2);
    EXPECT_EQ(grown(labels, 0)(5, 3), 0);
}

TEST(View, UsablePixelsAreThoseWithoutPeople) {
    View view;
    view.color = ColorImage(3, 2);
    EXPECT_EQ(usable_pixels(view)(2, 1), 255) << "people are not known";
    view.people = LabelImage(3, 2);
    view.people(2, 1) = 1;
    EXPECT_EQ(usable_pixels(view)(2, 1), 0);
    EXPECT_EQ(usable_pixels(view)(0, 0), 255);
}

}  // namespace
}  // namespace posefusion
