#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/vulkan/device_info.hpp"
#include "engine/vulkan/software_driver.hpp"

// Which device is taken, and how the software driver of our own joins those of the system.
namespace posefusion::test {
namespace {

DeviceInfo device(int index, const std::string& name, const std::string& kind, std::uint32_t driver_version = 1) {
    DeviceInfo info;
    info.index = index;
    info.name = name;
    info.kind = kind;
    info.driver = name + " driver " + std::to_string(driver_version);
    info.driver_version = driver_version;
    return info;
}

const std::vector<DeviceInfo> kDevices{device(0, "llvmpipe", "cpu", 22), device(1, "llvmpipe", "cpu", 25),
                                       device(2, "Shiny 9", "integrated"), device(3, "Shiny 10", "discrete")};

TEST(DeviceChoice, TheBestKindThenTheNewestSoftwareDriver) {
    EXPECT_EQ(choose_device(kDevices, "").index, 3u);
    EXPECT_EQ(choose_device({kDevices[0], kDevices[1], kDevices[2]}, "").index, 2u);
    EXPECT_EQ(choose_device({kDevices[0], kDevices[1]}, "").index, 1u);
    EXPECT_EQ(choose_device({kDevices[1], kDevices[0]}, "").index, 0u);
    EXPECT_NE(choose_device({kDevices[0], kDevices[1]}, "").reason.find("newest"), std::string::npos);
    EXPECT_EQ(choose_device({kDevices[0]}, "").reason, "the only one");
}

TEST(DeviceChoice, ByNameDriverOrIndex) {
    EXPECT_EQ(choose_device(kDevices, "SHINY 9").index, 2u);
    EXPECT_EQ(choose_device(kDevices, "LLVMpipe").index, 1u) << "of those that match, the best";
    EXPECT_EQ(choose_device(kDevices, "driver 22").index, 0u);
    EXPECT_EQ(choose_device(kDevices, "0").index, 0u);
    EXPECT_THROW((void)choose_device(kDevices, "voodoo"), Error);
    EXPECT_THROW((void)choose_device(kDevices, "4"), Error);
    EXPECT_THROW((void)choose_device({}, ""), Error);
}

TEST(DeviceChoice, WhatLacksSomethingIsNotTaken) {
    std::vector<DeviceInfo> devices = kDevices;
    devices[3].missing = {"a compute queue"};
    EXPECT_EQ(choose_device(devices, "").index, 2u);
    try {
        (void)choose_device(devices, "Shiny 10");
        FAIL() << "it cannot be used";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("a compute queue"), std::string::npos) << error.what();
    }
}

TEST(SoftwareDriver, IsAddedToWhatThereIs) {
    EXPECT_EQ(with_driver({"", "", ""}, "/d/lvp.json"), "/d/lvp.json");
    EXPECT_EQ(with_driver({"", "", "/other.json"}, "/d/lvp.json"), "/other.json:/d/lvp.json");
    EXPECT_EQ(with_driver({"", "", "/other.json:/d/lvp.json"}, "/d/lvp.json"), std::nullopt) << "it is there already";
}

TEST(SoftwareDriver, NeverAgainstTheUsersChoice) {
    EXPECT_EQ(with_driver({"/mine.json", "", ""}, "/d/lvp.json"), std::nullopt);
    EXPECT_EQ(with_driver({"", "/mine.json", ""}, "/d/lvp.json"), std::nullopt);
}

}  // namespace
}  // namespace posefusion::test
