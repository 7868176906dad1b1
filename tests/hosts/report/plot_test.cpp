#include "hosts/report/plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace posefusion {
namespace {

constexpr Rgb8 kRed{255, 0, 0};

struct Box {
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Box box_of(const ColorImage& image, Rgb8 color) {
    Box box;
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < image.width(); ++u)
            if (image(u, v) == color)
                box = {std::min(box.left, u), std::max(box.right, u), std::min(box.top, v), std::max(box.bottom, v)};
    return box;
}

TEST(Plot, ALineRunsFromCornerToCorner) {
    const ColorImage image = draw_plot({{"", kRed, {{0, 0}, {10, 5}}}}, {});
    const Box box = box_of(image, kRed);
    EXPECT_GT(box.right - box.left, 450);
    EXPECT_GT(box.bottom - box.top, 300);
}

TEST(Plot, EqualAxesKeepASquareSquare) {
    PlotConfig config;
    config.equal_axes = true;
    const ColorImage image = draw_plot({{"", kRed, {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}}}}, config);
    const Box box = box_of(image, kRed);
    EXPECT_NEAR(box.right - box.left, box.bottom - box.top, 2);
    EXPECT_GT(box.right - box.left, 200);
}

TEST(Plot, GapsAndEmptyInputAreFine) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NO_THROW((void)draw_plot({}, {}));
    EXPECT_NO_THROW((void)draw_plot({{"empty", kRed, {}}}, {}));
    EXPECT_NO_THROW((void)draw_plot({{"constant", kRed, {{1, 1}, {2, 1}}}}, {}));
    const Box whole = box_of(draw_plot({{"", kRed, {{0, 0}, {5, 1}, {10, 0}}}}, {}), kRed);
    const ColorImage gap = draw_plot({{"", kRed, {{0, 0}, {nan, nan}, {10, 1}}}}, {});
    EXPECT_GT(whole.right - whole.left, 400);
    EXPECT_LT(box_of(gap, kRed).right, 0) << "no line across a gap";
}

TEST(Plot, SpansAreShadedWhereTheyLie) {
    PlotConfig config;
    config.spans = {{5, 7.5, {255, 240, 240}}, {2.5, 2.5, {0, 200, 0}}, {20, 30, {0, 0, 255}}};
    const ColorImage image = draw_plot({{"", kRed, {{0, 0}, {10, 1}}}}, config);
    const Box line = box_of(image, kRed), shaded = box_of(image, {255, 240, 240}), mark = box_of(image, {0, 200, 0});
    const auto at = [&](double x) { return line.left + x / 10 * (line.right - line.left); };
    EXPECT_NEAR(shaded.left, at(5), 3);
    EXPECT_NEAR(shaded.right, at(7.5), 3);
    EXPECT_GT(shaded.bottom - shaded.top, line.bottom - line.top) << "from top to bottom";
    EXPECT_NEAR(mark.left, at(2.5), 3);
    EXPECT_EQ(mark.left, mark.right) << "a moment is a line";
    EXPECT_LT(box_of(image, {0, 0, 255}).right, 0) << "out of range";
}

TEST(Plot, ANameAtTheStartIsWrittenThereAndNotInTheLegend) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Eigen::Vector2d> points{{nan, nan}, {2, 2}, {4, 2}, {10, 0}, {0, 0}};
    const ColorImage unnamed = draw_plot({{"", kRed, points}}, {}),
                     named = draw_plot({{"abc", kRed, points, true}}, {}),
                     legend = draw_plot({{"abc", kRed, points}}, {});
    const auto change = [&](const ColorImage& picture) {
        ColorImage changed(picture.width(), picture.height());
        for (std::size_t i = 0; i < picture.size(); ++i)
            if (picture[i] != unnamed[i]) changed[i] = kRed;
        return box_of(changed, kRed);
    };
    const Box line = box_of(unnamed, kRed), name = change(named);
    const int start = line.left + (line.right - line.left) / 5;
    EXPECT_LT(std::abs(name.left - start), 10) << "a dot";
    EXPECT_LT(std::abs(name.bottom - line.top), 10);
    EXPECT_GT(name.right - name.left, 20) << "and three letters";
    EXPECT_LT(name.right - name.left, 60);
    EXPECT_GT(name.top, change(legend).bottom);
}

TEST(Plot, PicturesStandBesideEachOther) {
    const ColorImage row = beside({ColorImage(10, 5, kRed), ColorImage(20, 8, {0, 0, 255})});
    EXPECT_EQ(row.width(), 30);
    EXPECT_EQ(row.height(), 8);
    EXPECT_EQ(row(9, 4), kRed);
    EXPECT_EQ(row(9, 6), (Rgb8{255, 255, 255}));
    EXPECT_EQ(row(10, 7), (Rgb8{0, 0, 255}));
}

}  // namespace
}  // namespace posefusion
