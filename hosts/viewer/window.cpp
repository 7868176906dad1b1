#include "hosts/viewer/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <imgui.h>
#include <unistd.h>

#include <string_view>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/vulkan/context.hpp"
#include "engine/vulkan/software_driver.hpp"
#include "hosts/run/exit_code.hpp"

namespace posefusion {
namespace {

constexpr const char* kInstead = "; `posefusion run RECORDING` does the same without a window";

std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "" : " (" + std::string(text) + ")";
}

/// Without this, Xlib ends the program by exit(), whose destructors run while our threads draw and track.
int end_without_display(void* /*display*/) {
    constexpr std::string_view kMessage = "posefusion: the display has gone, and the window with it\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
    _exit(kExitError);
}

/// GLFW brings Xlib into the program where the display is one of X11.
void end_at_once_without_display() {
    using Handler = int (*)(void*);
    const auto set_handler = reinterpret_cast<Handler (*)(Handler)>(dlsym(RTLD_DEFAULT, "XSetIOErrorHandler"));
    if (set_handler != nullptr) set_handler(&end_without_display);
}

Window& self(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

}  // namespace

template <class Handler>
void Window::call(GLFWwindow* glfw_window, Handler handler) {
    Window& window = self(glfw_window);
    try {
        window.handlers_.any();
        handler(window);
    } catch (...) {
        window.thrown_ = std::current_exception();
    }
}

Window::Window(const std::string& title, WindowSize size) {
    if (!glfwInit()) throw Error("there is no display to open a window on" + glfw_reason() + kInstead);
    end_at_once_without_display();
    offer_software_driver();  // GLFW asks Vulkan before the engine does
    if (!glfwVulkanSupported()) {
        glfwTerminate();
        throw Error("Vulkan cannot draw to windows of this display" + glfw_reason() + kInstead);
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string reason = glfw_reason();
        glfwTerminate();
        throw Error("no window can be opened on this display" + reason + kInstead);
    }
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) {
        call(w, [&](Window& window) {
            if (action == GLFW_PRESS && !ImGui::GetIO().WantTextInput) window.handlers_.key(key);
        });
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
        call(w, [&](Window& window) {
            const bool ours = action == GLFW_PRESS && !ImGui::GetIO().WantCaptureMouse;
            window.held_button_ = ours ? button : -1;
            glfwGetCursorPos(w, &window.last_x_, &window.last_y_);
        });
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
        call(w, [&](Window& window) {
            const double dx = x - window.last_x_, dy = y - window.last_y_;
            window.last_x_ = x, window.last_y_ = y;
            if (window.held_button_ >= 0) window.handlers_.drag(window.held_button_, dx, dy);
        });
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double steps) {
        call(w, [&](Window& window) {
            if (!ImGui::GetIO().WantCaptureMouse) window.handlers_.scroll(steps);
        });
    });
    glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { call(w, [](Window&) {}); });
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { call(w, [](Window&) {}); });
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

std::vector<std::string> Window::instance_extensions() const {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return {names, names + count};
}

VkSurfaceKHR Window::create_surface(VkInstance instance) const {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    vulkan::check(glfwCreateWindowSurface(instance, window_, nullptr, &surface), "glfwCreateWindowSurface");
    return surface;
}

WindowSize Window::size() const {
    if (minimised()) return {};
    WindowSize size;
    glfwGetFramebufferSize(window_, &size.width, &size.height);
    return size;
}

bool Window::minimised() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE; }
bool Window::close_wanted() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }
void Window::resize(WindowSize size) { glfwSetWindowSize(window_, size.width, size.height); }
void Window::minimise() { glfwIconifyWindow(window_); }
void Window::restore() { glfwRestoreWindow(window_); }

void Window::events(double seconds) {
    if (seconds > 0)
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

}  // namespace posefusion
