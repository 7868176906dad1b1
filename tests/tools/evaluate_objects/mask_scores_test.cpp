#include "tools/evaluate_objects/mask_scores.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// One row of labels.
LabelImage row(std::initializer_list<int> labels) {
    LabelImage image(static_cast<int>(labels.size()), 1);
    std::size_t i = 0;
    for (const int label : labels) image[i++] = static_cast<std::uint8_t>(label);
    return image;
}

TEST(MaskScores, CountPixelsOfThingsThatMove) {
    MaskScores scores;
    // Hit as a mover, hit as part of a person, missed, static taken for a mover, people taken for movers.
    add_frame(scores, row({101, 1, 0, 101, 101, 0}), row({101, 101, 101, 0, 1, 0}), {{101, ObjectState::Moves}});
    EXPECT_EQ(scores.hit, 2u);
    EXPECT_EQ(scores.missed, 1u);
    EXPECT_EQ(scores.right, 1u);
    EXPECT_EQ(scores.wrong, 1u);
    EXPECT_DOUBLE_EQ(scores.recall(), 2.0 / 3);
    EXPECT_DOUBLE_EQ(scores.precision(), 0.5);
}

TEST(MaskScores, WhatStandsOrHasJustBegunMayBeLeftOutOrNot) {
    for (const ObjectState state : {ObjectState::Stands, ObjectState::Begins}) {
        MaskScores scores;
        add_frame(scores, row({101, 0}), row({101, 101}), {{101, state}});
        EXPECT_EQ(scores.hit + scores.missed + scores.right + scores.wrong, 0u);
        EXPECT_DOUBLE_EQ(scores.recall(), 1);
        EXPECT_DOUBLE_EQ(scores.precision(), 1);
    }
}

TEST(MaskScores, OverlapIsThatOfTheFramesInWhichTheRunHasTheObject) {
    MaskScores scores;
    add_frame(scores, row({0, 0, 0, 0}), row({102, 102, 102, 102}), {});  // not known yet
    add_frame(scores, row({101, 101, 101, 0}), row({0, 102, 102, 102}), {});
    EXPECT_DOUBLE_EQ(scores.iou(102, 101), 0.5);
    EXPECT_DOUBLE_EQ(scores.iou(103, 101), 0);
}

TEST(MaskScores, RefusesMasksOfDifferentSizes) {
    MaskScores scores;
    EXPECT_THROW(add_frame(scores, row({0, 0}), row({0}), {}), Error);
}

}  // namespace
}  // namespace posefusion
