#pragma once
#include <string>

/// Names of ROS 2 in bags.
namespace posefusion {

/// "sensor_msgs/msg/Image" as ROS 1 has it: "sensor_msgs/Image".
[[nodiscard]] inline std::string short_type(std::string type) {
    constexpr const char* kMiddle = "/msg/";
    const std::size_t at = type.find(kMiddle);
    return at == std::string::npos ? type : type.erase(at, std::string(kMiddle).size() - 1);
}

}  // namespace posefusion
