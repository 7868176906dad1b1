#pragma once
#include <vulkan/vulkan.h>

#include <exception>
#include <functional>
#include <string>
#include <vector>

struct GLFWwindow;

namespace posefusion {

/// Pixels of a window's drawing area; 0 x 0 while it is minimised.
struct WindowSize {
    int width = 0, height = 0;
    friend bool operator==(const WindowSize&, const WindowSize&) = default;
};

/// A window of the desktop (GLFW), to be used by one thread, the main one.
class Window {
public:
    /// Throws Error where there is no display, naming the command that needs no window.
    Window(const std::string& title, WindowSize size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Vulkan's instance extensions that create_surface() needs.
    [[nodiscard]] std::vector<std::string> instance_extensions() const;
    [[nodiscard]] VkSurfaceKHR create_surface(VkInstance instance) const;

    [[nodiscard]] GLFWwindow* handle() const { return window_; }
    [[nodiscard]] WindowSize size() const;
    [[nodiscard]] bool minimised() const;
    [[nodiscard]] bool close_wanted() const;
    void resize(WindowSize size);
    void minimise();
    void restore();
    /// Handles pending events; waits up to `seconds` for the first. Passes on exceptions of the handlers.
    void events(double seconds);

    /// Event handlers, called from events() unless a panel handles the event.
    struct Handlers {
        std::function<void(int key)> key = [](int) {};  ///< pressed; GLFW's number
        std::function<void(int button, double dx, double dy)> drag = [](int, double, double) {};  ///< pixels
        std::function<void(double steps)> scroll = [](double) {};
        std::function<void()> any = [] {};  ///< any event, whether it is handled or not
    };
    void set_handlers(Handlers handlers) { handlers_ = std::move(handlers); }

private:
    /// GLFW is C: exceptions of handlers must not pass through it.
    template <class Handler>
    static void call(GLFWwindow* window, Handler handler);

    GLFWwindow* window_ = nullptr;
    Handlers handlers_;
    double last_x_ = 0, last_y_ = 0;
    int held_button_ = -1;
    std::exception_ptr thrown_;
};

}  // namespace posefusion
