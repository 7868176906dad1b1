#include <algorithm>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "engine/core/error.hpp"
#include "pose/first_line.hpp"
#include "pose/onnx_file.hpp"
#include "pose/runtime.hpp"

namespace posefusion {
namespace {

/// OpenCV's importers log an error to stderr before they throw it; the exception says everything.
class QuietOpenCv {
public:
    QuietOpenCv() : previous_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
    ~QuietOpenCv() { cv::utils::logging::setLogLevel(previous_); }
    QuietOpenCv(const QuietOpenCv&) = delete;
    QuietOpenCv& operator=(const QuietOpenCv&) = delete;

private:
    cv::utils::logging::LogLevel previous_;
};

class OpenCvNetwork final : public NetworkRuntime {
public:
    explicit OpenCvNetwork(const NetworkFile& file) : path_(file.model.string()), outputs_(file.outputs) {
        const QuietOpenCv quiet;
        const bool caffe = file.model.extension() == ".caffemodel";
        try {
            network_ =
                caffe ? cv::dnn::readNetFromCaffe(file.prototxt.string(), path_) : cv::dnn::readNetFromONNX(path_);
        } catch (const cv::Exception& error) {
            throw Error(path_ + " is not a network that OpenCV " CV_VERSION " can read: " + first_line(error.err));
        }
        if (!caffe) fixed_ = declared_input_size(file.model);
        network_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
        network_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
        const std::vector<std::string> available = network_.getUnconnectedOutLayersNames();
        if (outputs_.empty()) outputs_ = available;
        for (const std::string& name : outputs_) {
            if (std::find(available.begin(), available.end(), name) == available.end()) {
                throw Error(path_ + " is not the network expected: it has no output '" + name + "'");
            }
        }
        cv::setNumThreads(file.threads);  // OpenCV has one number for the whole program
    }

    InputSize fixed_input() const override { return fixed_; }

    std::vector<Tensor> run(const Tensor& image) override {
        // The header only borrows the pixels; OpenCV does not write to a network's input.
        const cv::Mat blob(static_cast<int>(image.shape.size()), image.shape.data(), CV_32F,
                           const_cast<float*>(image.values.data()));
        std::vector<cv::Mat> results;
        const QuietOpenCv quiet;
        try {
            network_.setInput(blob);
            network_.forward(results, outputs_);
        } catch (const cv::Exception& error) {
            throw Error(path_ + " cannot take an image of " + std::to_string(image.width()) + " x " +
                        std::to_string(image.height()) + " pixels in OpenCV: " + first_line(error.err));
        }
        std::vector<Tensor> tensors;
        for (const cv::Mat& result : results) tensors.push_back(copy(result));
        return tensors;
    }

    std::string description() const override { return "OpenCV DNN " CV_VERSION; }

private:
    static Tensor copy(const cv::Mat& map) {
        Tensor tensor;
        tensor.shape.assign(map.size.p, map.size.p + map.dims);
        const cv::Mat continuous = map.isContinuous() ? map : map.clone();
        tensor.values.assign(continuous.ptr<float>(), continuous.ptr<float>() + continuous.total());
        return tensor;
    }

    std::string path_;
    cv::dnn::Net network_;
    std::vector<std::string> outputs_;
    InputSize fixed_;
};

}  // namespace

std::unique_ptr<NetworkRuntime> load_with_opencv(const NetworkFile& file) {
    return std::make_unique<OpenCvNetwork>(file);
}

}  // namespace posefusion
