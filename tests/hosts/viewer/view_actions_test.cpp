#include "hosts/viewer/view_actions.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace posefusion {
namespace {

TEST(ViewActions, EveryKeyDoesOneThingAndEveryThingHasAKey) {
    std::set<int> keys;
    std::set<std::string> names;
    std::set<ViewAction> actions;
    for (const KeyBinding& binding : key_bindings()) {
        EXPECT_TRUE(keys.insert(binding.key).second) << binding.name << " is there twice";
        EXPECT_TRUE(names.insert(binding.name).second);
        EXPECT_TRUE(actions.insert(binding.action).second) << binding.name;
        EXPECT_FALSE(std::string(binding.meaning).empty());
        EXPECT_EQ(action_of_key(binding.key), binding.action);
        EXPECT_EQ(action_of_key_name(binding.name), binding.action);
    }
    EXPECT_EQ(actions.size(), static_cast<std::size_t>(ViewAction::Close) + 1);
}

TEST(ViewActions, OtherKeysDoNothing) {
    EXPECT_EQ(action_of_key(-1), std::nullopt);
    EXPECT_EQ(action_of_key_name("Hyper"), std::nullopt);
    EXPECT_EQ(action_of_key_name(""), std::nullopt);
    EXPECT_EQ(action_of_key_name("space"), ViewAction::PlayPause) << "any case";
}

}  // namespace
}  // namespace posefusion
