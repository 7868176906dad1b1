#include "engine/vulkan/context.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/vulkan/available_memory.hpp"
#include "engine/vulkan/software_driver.hpp"

namespace posefusion {
namespace {

constexpr VkDeviceSize kBlockSize = VkDeviceSize{32} << 20;  // small buffers share blocks of this size
constexpr std::uint32_t kMinSharedMemory = 4096;
constexpr std::uint32_t kMinStorageBuffers = 16;                            // per kernel
constexpr std::uint32_t kMemoryInFiles = VK_MAKE_API_VERSION(0, 23, 0, 0);  // Mesa's software driver, from this version
// Of Mesa's software driver with LLVM, measured with versions 22 and 25, one thread and images of 640 x 480: what
// loading it takes, and what compiling all shaders and a run take after that. Threads reserve address space they do not
// use.
constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kSpaceToLoad = 192 * kMiB, kMemoryToLoad = 64 * kMiB;
constexpr std::uint64_t kSpaceToRun = 768 * kMiB, kMemoryToRun = 320 * kMiB;
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

std::string version_text(std::uint32_t v) {
    return std::to_string(VK_API_VERSION_MAJOR(v)) + "." + std::to_string(VK_API_VERSION_MINOR(v)) + "." +
           std::to_string(VK_API_VERSION_PATCH(v));
}

/// The version in a driver's description ("22.3.6"), since not every driver fills in VkPhysicalDeviceProperties; 0 if
/// there is none.
std::uint32_t version_in(const char* text) {
    unsigned major = 0, minor = 0, patch = 0;
    while (*text != '\0' && std::sscanf(text, "%u.%u.%u", &major, &minor, &patch) < 2) ++text;
    return *text == '\0' ? 0 : VK_MAKE_API_VERSION(0, major, minor, patch);
}

const char* kind_text(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "cpu";
        default:
            return "other";
    }
}

struct Features {
    VkPhysicalDeviceShaderAtomicInt64Features atomics{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_INT64_FEATURES};
    VkPhysicalDeviceSynchronization2Features sync2{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES};
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    Features() {
        core.pNext = &atomics;
        atomics.pNext = &sync2;
    }
    Features(const Features&) = delete;
    Features& operator=(const Features&) = delete;
};

/// The first queue family that supports compute and the flags in `more`.
std::uint32_t compute_family(VkPhysicalDevice device, VkQueueFlags more = 0, VkQueueFamilyProperties* found = nullptr) {
    const VkQueueFlags wanted = VK_QUEUE_COMPUTE_BIT | more;
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i) {
        if ((families[i].queueFlags & wanted) == wanted) {
            if (found) *found = families[i];
            return i;
        }
    }
    return VK_QUEUE_FAMILY_IGNORED;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

DeviceInfo describe(VkPhysicalDevice device, int index) {
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    properties.pNext = &subgroup;
    subgroup.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device, &properties);
    const auto& core = properties.properties;

    DeviceInfo info;
    info.index = index;
    info.name = core.deviceName;
    info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
    info.driver_version = version_in(driver.driverInfo);
    info.api_version = version_text(core.apiVersion);
    info.kind = kind_text(core.deviceType);
    info.subgroup_size = subgroup.subgroupSize;

    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(device, &memory);
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) {
            info.memory_bytes = std::max(info.memory_bytes, std::uint64_t{memory.memoryHeaps[i].size});
        }
    }

    if (core.apiVersion < VK_API_VERSION_1_2) {
        info.missing.push_back("Vulkan 1.2");
        return info;  // the queries below need 1.2
    }
    Features features;
    vkGetPhysicalDeviceFeatures2(device, &features.core);
    info.int64_atomics = features.atomics.shaderBufferInt64Atomics && features.core.features.shaderInt64;
    if (core.apiVersion < VK_API_VERSION_1_3 && !has_extension(device, VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME)) {
        info.missing.push_back("synchronization2");
    }
    if (compute_family(device) == VK_QUEUE_FAMILY_IGNORED) info.missing.push_back("a compute queue");
    if (!(subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) ||
        !(subgroup.supportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT)) {
        info.missing.push_back("subgroup arithmetic in compute shaders");
    }
    if (core.limits.maxPerStageDescriptorStorageBuffers < kMinStorageBuffers) {
        info.missing.push_back(std::to_string(kMinStorageBuffers) + " storage buffers per kernel");
    }
    if (core.limits.maxComputeWorkGroupInvocations < 256 || core.limits.maxComputeSharedMemorySize < kMinSharedMemory) {
        info.missing.push_back("workgroups of 256 invocations");
    }
    return info;
}

/// Adds what a renderer needs and the device lacks to `missing`.
void check_sharing(VkPhysicalDevice device, const DeviceSharing& sharing, std::vector<std::string>& missing) {
    for (const auto& name : sharing.device_extensions) {
        if (!has_extension(device, name.c_str())) missing.push_back(name);
    }
    if (sharing.graphics && compute_family(device, VK_QUEUE_GRAPHICS_BIT) == VK_QUEUE_FAMILY_IGNORED) {
        missing.push_back("a queue that computes and draws");
    }
}

/// Keeps the drivers loaded for the life of the process. The loader unloads them with the last instance, and some
/// cannot be loaded again more than a few dozen times.
void keep_drivers_loaded() {
    static const VkInstance keeper = [] {
        VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        VkInstance instance = VK_NULL_HANDLE;
        return vkCreateInstance(&create, nullptr, &instance) == VK_SUCCESS ? instance : VK_NULL_HANDLE;
    }();
    (void)keeper;
}

VkInstance make_instance(bool validation, const std::vector<std::string>& more_extensions = {}) {
    offer_software_driver();
    require_memory(kSpaceToLoad, kMemoryToLoad, "to load a Vulkan driver");
    keep_drivers_loaded();
    VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    app.pApplicationName = "PoseFusion";
    app.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    create.pApplicationInfo = &app;
    std::vector<const char*> extensions;
    for (const auto& name : more_extensions) extensions.push_back(name.c_str());
    const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
    if (validation) {
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = &synchronization;
        create.pNext = &features;
        create.enabledLayerCount = 1;
        create.ppEnabledLayerNames = &kValidationLayer;
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    create.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    create.ppEnabledExtensionNames = extensions.data();
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult result = vkCreateInstance(&create, nullptr, &instance);
    if (result == VK_ERROR_LAYER_NOT_PRESENT) {
        throw Error("Vulkan: the validation layer is not installed; install the package vulkan-validationlayers");
    }
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return VK_NULL_HANDLE;  // a loader without a driver
    vulkan::check(result, "vkCreateInstance");
    return instance;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
    if (!instance) return {};
    std::uint32_t count = 0;
    if (vkEnumeratePhysicalDevices(instance, &count, nullptr) != VK_SUCCESS) return {};
    std::vector<VkPhysicalDevice> devices(count);
    vulkan::check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
    devices.resize(count);
    return devices;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// Rank of the kind of device; larger is better.
int rank(const DeviceInfo& info) {
    if (info.kind == "discrete") return 3;
    if (info.kind == "integrated") return 2;
    return info.kind == "virtual" ? 1 : 0;
}

bool is_better(const DeviceInfo& a, const DeviceInfo& b) {
    if (rank(a) != rank(b)) return rank(a) > rank(b);
    return a.kind == "cpu" && a.name == b.name && a.driver_version > b.driver_version;
}

std::string reason_for(const DeviceInfo& chosen, std::size_t candidates) {
    if (candidates == 1) return "the only one";
    return chosen.kind == "cpu" ? "there is no GPU, and its software driver is the newest"
                                : "the best kind: " + chosen.kind;
}

std::string join(const std::vector<std::string>& parts) {
    std::string text;
    for (const auto& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

}  // namespace

DeviceChoice choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted) {
    if (devices.empty()) {
        throw Error(
            "no Vulkan device found; install a driver (mesa-vulkan-drivers brings lavapipe, which needs no GPU)");
    }
    const bool is_index = !wanted.empty() && std::all_of(wanted.begin(), wanted.end(),
                                                         [](unsigned char c) { return std::isdigit(c) != 0; });
    const auto is_wanted = [&](const DeviceInfo& info) {
        if (is_index) return std::to_string(info.index) == wanted;
        return wanted.empty() || lower(info.name + '\n' + info.driver).find(lower(wanted)) != std::string::npos;
    };
    const DeviceInfo* best = nullptr;
    std::size_t candidates = 0;
    std::string reasons;
    for (const auto& info : devices) {
        if (!is_wanted(info)) continue;
        if (!info.missing.empty()) {
            reasons += " (" + info.name + " lacks " + join(info.missing) + ")";
            continue;
        }
        ++candidates;
        if (best == nullptr || is_better(info, *best)) best = &info;
    }
    if (best == nullptr) {
        throw Error("no usable Vulkan device" + (wanted.empty() ? std::string() : " matches '" + wanted + "'") +
                    reasons + "; `posefusion devices` lists what there is");
    }
    return {static_cast<std::size_t>(best - devices.data()), reason_for(*best, candidates)};
}

std::vector<DeviceInfo> list_devices() {
    const VkInstance instance = make_instance(false);
    std::vector<DeviceInfo> infos;
    for (const auto device : physical_devices(instance))
        infos.push_back(describe(device, static_cast<int>(infos.size())));
    if (instance) vkDestroyInstance(instance, nullptr);
    return infos;
}

namespace vulkan {

void check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY) {
        throw Error(std::string("Vulkan: out of memory in ") + call + "; use --scale 0.5 or a device with more memory");
    }
    if (result == VK_ERROR_DEVICE_LOST) {
        throw Error(std::string("Vulkan: the device was lost in ") + call + "; the driver log (dmesg) says why");
    }
    throw Error(std::string("Vulkan: ") + call + " failed with code " + std::to_string(result) +
                "; `posefusion devices` shows the driver in use");
}

Context::Context(const ContextOptions& options) {
    try {
        create_instance(options);
        create_device(options);
    } catch (...) {
        destroy();
        throw;
    }
}

Context::~Context() { destroy(); }

void Context::destroy() {
    if (device_) {
        vkDeviceWaitIdle(device_);
        for (const auto& block : blocks_) {
            if (block.memory) vkFreeMemory(device_, block.memory, nullptr);
        }
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy_messenger(instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

VkBool32 Context::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                             const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
    ++static_cast<Context*>(self)->validation_messages_;
    std::fprintf(stderr, "Vulkan validation: %s\n", data->pMessage);
    return VK_FALSE;
}

void Context::create_instance(const ContextOptions& options) {
    instance_ = make_instance(options.validation, options.sharing.instance_extensions);
    if (!instance_ || !options.validation) return;
    VkDebugUtilsMessengerCreateInfoEXT create{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    create.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    create.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    create.pfnUserCallback = &Context::on_message;
    create.pUserData = this;
    const auto create_messenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    check(create_messenger(instance_, &create, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    set_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        vkGetInstanceProcAddr(instance_, "vkSetDebugUtilsObjectNameEXT"));
}

void Context::create_device(const ContextOptions& options) {
    const auto devices = physical_devices(instance_);
    const DeviceSharing& sharing = options.sharing;
    std::vector<DeviceInfo> infos;
    for (const auto device : devices) {
        infos.push_back(describe(device, static_cast<int>(infos.size())));
        check_sharing(device, sharing, infos.back().missing);
    }
    const std::size_t chosen = choose_device(infos, options.device).index;
    physical_ = devices[chosen];
    info_ = infos[chosen];
    if (info_.kind == "cpu") require_memory(kSpaceToRun, kMemoryToRun, "for the software driver");
    int64_atomics_ = info_.int64_atomics && options.allow_int64_atomics;

    VkQueueFamilyProperties family{};
    queue_family_ = compute_family(physical_, sharing.graphics ? VK_QUEUE_GRAPHICS_BIT : 0, &family);
    const std::uint32_t timestamp_bits = family.timestampValidBits;
    timestamp_mask_ = timestamp_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << timestamp_bits) - 1;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical_, &properties);
    timestamp_period_ns_ = static_cast<double>(properties.limits.timestampPeriod);
    max_buffer_bytes_ = properties.limits.maxStorageBufferRange;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_properties_);

    const bool second = sharing.graphics && family.queueCount > 1;
    const float priorities[] = {1.0f, 0.0f};  // the renderer after the engine
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queue_family_;
    queue.queueCount = second ? 2 : 1;
    queue.pQueuePriorities = priorities;
    Features features;
    features.core.features.shaderInt64 = int64_atomics_;
    VkPhysicalDeviceFeatures supported;
    vkGetPhysicalDeviceFeatures(physical_, &supported);
    features.core.features.largePoints = sharing.graphics && supported.largePoints;
    features.atomics.shaderBufferInt64Atomics = int64_atomics_;
    features.sync2.synchronization2 = VK_TRUE;
    std::vector<const char*> extensions;
    for (const auto& name : sharing.device_extensions) extensions.push_back(name.c_str());
    if (properties.apiVersion < VK_API_VERSION_1_3) extensions.push_back(VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME);
    VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    create.pNext = &features.core;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue;
    create.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    create.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(physical_, &create, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    vkGetDeviceQueue(device_, queue_family_, second ? 1 : 0, &renderer_queue_);
}

std::uint32_t Context::memory_type(std::uint32_t allowed, MemoryKind kind) const {
    const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    // reading back from uncached memory is slow, so cached host memory first
    const VkMemoryPropertyFlags wishes[2][2] = {{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0},
                                                {host | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, host}};
    for (const auto flags : wishes[kind == MemoryKind::Host]) {
        for (std::uint32_t i = 0; i < memory_properties_.memoryTypeCount; ++i) {
            if ((allowed & (1u << i)) && (memory_properties_.memoryTypes[i].propertyFlags & flags) == flags) return i;
        }
    }
    throw Error("Vulkan: device '" + info_.name + "' has no suitable memory type; choose another with --device");
}

/// Newer software drivers keep device memory in files without names, which the limit on the size of files cuts short;
/// they do not notice, and the first access beyond it ends the program.
void Context::check_file_limit(VkDeviceSize size) const {
    if (info_.kind != "cpu" || info_.driver_version < kMemoryInFiles) return;
    rlimit limit{};
    if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= size) return;
    throw Error("files may grow to " + std::to_string(limit.rlim_cur >> 10) + " KiB only, but the software driver (" +
                info_.driver + ") keeps memory in one of " + std::to_string(size >> 10) +
                " KiB; raise the limit (ulimit -f unlimited)");
}

Context::Block& Context::add_block(VkDeviceSize size, std::uint32_t type, MemoryKind kind) {
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = size;
    allocate.memoryTypeIndex = type;
    check_file_limit(size);
    Block block;
    // never ask for more than the heap holds; a driver that backs memory by a sparse file would grant it
    const VkDeviceSize heap = memory_properties_.memoryHeaps[memory_properties_.memoryTypes[type].heapIndex].size;
    const VkResult result =
        size > heap ? VK_ERROR_OUT_OF_DEVICE_MEMORY : vkAllocateMemory(device_, &allocate, nullptr, &block.memory);
    if (result != VK_SUCCESS) {
        throw Error("device '" + info_.name + "' is out of memory: " + std::to_string(size >> 20) +
                    " MiB more were asked for, " + std::to_string(allocated_bytes_ >> 20) +
                    " MiB are in use; use --scale 0.5 or a device with more memory");
    }
    block.size = size;
    block.type = type;
    block.free = {{0, size}};
    if (kind == MemoryKind::Host) {
        void* mapped = nullptr;
        check(vkMapMemory(device_, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
        block.mapped = static_cast<std::byte*>(mapped);
    }
    allocated_bytes_ += size;
    auto slot = std::find_if(blocks_.begin(), blocks_.end(), [](const Block& b) { return !b.memory; });
    if (slot == blocks_.end()) slot = blocks_.insert(slot, Block{});
    *slot = std::move(block);
    return *slot;
}

Allocation Context::allocate(const VkMemoryRequirements& requirements, MemoryKind kind) {
    const std::lock_guard lock(memory_mutex_);
    const std::uint32_t type = memory_type(requirements.memoryTypeBits, kind);
    const auto take = [&](Block& block) -> Allocation {
        if (!block.memory || block.type != type || (kind == MemoryKind::Host) != (block.mapped != nullptr)) return {};
        for (auto range = block.free.begin(); range != block.free.end(); ++range) {
            const VkDeviceSize start =
                (range->offset + requirements.alignment - 1) / requirements.alignment * requirements.alignment;
            const VkDeviceSize end = start + requirements.size;
            const VkDeviceSize range_end = range->offset + range->size;
            if (end > range_end) continue;
            const VkDeviceSize offset = range->offset;
            range = block.free.erase(range);
            if (end < range_end) range = block.free.insert(range, {end, range_end - end});
            if (offset < start) block.free.insert(range, {offset, start - offset});
            block.used += requirements.size;
            return {block.memory, start, requirements.size, block.mapped ? block.mapped + start : nullptr,
                    static_cast<std::uint32_t>(&block - blocks_.data())};
        }
        return {};
    };
    for (auto& block : blocks_) {
        if (const auto allocation = take(block); allocation.memory) return allocation;
    }
    // large buffers get a block of their own, so that growing the map gives the old memory back
    const bool shared = requirements.size <= kBlockSize / 4;
    Block& block = add_block(shared ? kBlockSize : requirements.size, type, kind);
    block.shared = shared;
    return take(block);
}

void Context::release(const Allocation& allocation) {
    const std::lock_guard lock(memory_mutex_);
    Block& block = blocks_[allocation.block];
    block.used -= allocation.size;
    if (block.used == 0 && !block.shared) {
        vkFreeMemory(device_, block.memory, nullptr);
        allocated_bytes_ -= block.size;
        block = {};
        return;
    }
    auto after = std::find_if(block.free.begin(), block.free.end(),
                              [&](const Range& r) { return r.offset > allocation.offset; });
    after = block.free.insert(after, {allocation.offset, allocation.size});
    if (const auto next = after + 1; next != block.free.end() && after->offset + after->size == next->offset) {
        after->size += next->size;
        block.free.erase(next);
    }
    if (after != block.free.begin() && (after - 1)->offset + (after - 1)->size == after->offset) {
        (after - 1)->size += after->size;
        block.free.erase(after);
    }
}

void Context::name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
    if (!set_name_) return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = name.c_str();
    set_name_(device_, &info);
}

}  // namespace vulkan
}  // namespace posefusion
