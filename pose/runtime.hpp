#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pose/tensor.hpp"

namespace posefusion {

/// A network file and how to load it.
struct NetworkFile {
    std::filesystem::path model;       ///< .onnx or .caffemodel
    std::filesystem::path prototxt;    ///< beside a .caffemodel
    std::vector<std::string> outputs;  ///< the outputs wanted, in this order; empty = all, in the order of the model
    int threads = 2;                   ///< CPU threads
};

struct InputSize {
    int width = 0, height = 0;  ///< 0 = any
};

/// A loaded network: one image in, maps out. Same input, same output, whatever the number of threads.
class NetworkRuntime {
public:
    virtual ~NetworkRuntime() = default;
    [[nodiscard]] virtual InputSize fixed_input() const = 0;
    /// @param image  [1, 3, height, width]
    /// @return the outputs in the order of NetworkFile::outputs. Throws Error if the network cannot take the image.
    [[nodiscard]] virtual std::vector<Tensor> run(const Tensor& image) = 0;
    [[nodiscard]] virtual std::string description() const = 0;  ///< name and version of the runtime
};

/// Both throw Error if the file is missing, damaged, not supported, or lacks a wanted output.
[[nodiscard]] std::unique_ptr<NetworkRuntime> load_with_onnx_runtime(const NetworkFile& file);
[[nodiscard]] std::unique_ptr<NetworkRuntime> load_with_opencv(const NetworkFile& file);

}  // namespace posefusion
