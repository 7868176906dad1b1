#include "hosts/web/web_page.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/core/installed_file.hpp"
#include "hosts/report/html.hpp"
#include "hosts/report/page_text.hpp"
#include "hosts/web/map_pieces.hpp"
#include "hosts/web/page_assets.hpp"
#include "hosts/web/scene_json.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// A JavaScript module. Modules import each other by `name`; an import map leads from it to where the text is.
struct Module {
    std::string name, file, text;
};

struct LibraryFile {
    const char* name;
    const char* file;
};
constexpr std::array kLibrary{LibraryFile{"three", "three.module.min.js"},
                              LibraryFile{"three-core", "three.core.min.js"},
                              LibraryFile{"three/OrbitControls", "OrbitControls.js"}};
constexpr const char* kLibraryFolder = "threejs";
constexpr const char* kPageModulePrefix = "page/";
constexpr std::string_view kHtml = "index.html", kStyle = "style.css";

/// What a page may load: nothing but what is in it ...
constexpr const char* kSelfContainedPolicy =
    "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'";
/// ... or comes from its own server.
constexpr const char* kServedPolicy =
    "default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; img-src 'self' data: "
    "blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'";

std::string_view asset(std::string_view name) { return text_of(web_page_assets(), name); }

std::string read_library_file(const fs::path& folder, const char* name) {
    const fs::path file = folder.empty() ? installed_file(&kLibraryFolder, fs::path(kLibraryFolder) / name)
                                               .value_or(fs::path(POSEFUSION_THREE_LIBRARY) / name)
                                         : folder / name;
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in.good() && text.empty())
        throw Error(file.string() + ": cannot be read; tools/setup puts three.js, which the page needs, there");
    return text;
}

/// three.js names its second file relative to the first, which only has an address where there is a server.
std::string with_bare_import(std::string text) {
    constexpr std::string_view kRelative = "\"./three.core.min.js\"", kBare = "\"three-core\"";
    for (std::size_t at = 0; (at = text.find(kRelative, at)) != std::string::npos; at += kBare.size())
        text.replace(at, kRelative.size(), kBare);
    return text;
}

std::vector<Module> modules(const fs::path& library) {
    std::vector<Module> list;
    for (const LibraryFile& part : kLibrary)
        list.push_back({part.name, part.file, with_bare_import(read_library_file(library, part.file))});
    for (const PageAsset& a : web_page_assets())
        if (a.name.ends_with(".js"))
            list.push_back({kPageModulePrefix + std::string(a.name), std::string(a.name), std::string(a.text)});
    return list;
}

std::string import_map(const std::vector<Module>& modules, std::string (*url)(const Module&)) {
    nlohmann::ordered_json imports;
    for (const Module& module : modules) imports[module.name] = url(module);
    return script_json(nlohmann::ordered_json{{"imports", std::move(imports)}}.dump());
}

std::string data_url(const std::string& type, std::string_view bytes) {
    return "data:" + type + ";base64," + base64(bytes);
}

std::string piece_id(std::size_t piece) { return "piece-" + std::to_string(piece); }

/// Bytes as the text of an element, which the browser keeps without looking at it.
std::string piece_elements(const EncodedMap& map) {
    std::string html;
    for (std::size_t i = 0; i < map.pieces.size(); ++i)
        html += "<script type=\"text/plain\" id=\"" + piece_id(i) + "\">" + base64(map.pieces[i].bytes) + "</script>\n";
    return html;
}

}  // namespace

std::string self_contained_page(const WebScene& scene, const fs::path& library) {
    const EncodedMap map = encode_map(scene.surfels);
    const SceneUrls urls{[](std::size_t i) { return "#" + piece_id(i); },
                         [&](std::size_t i) { return data_url("image/jpeg", scene.keyframes[i].jpeg); }};
    const auto url = [](const Module& module) { return data_url("text/javascript", module.text); };
    return fill(asset(kHtml), {{"policy", kSelfContainedPolicy},
                               {"title", escaped(scene.title)},
                               {"style", "<style>\n" + std::string(asset(kStyle)) + "</style>"},
                               {"imports", import_map(modules(library), url)},
                               {"scene", script_json(scene_json(scene, map, urls))},
                               {"pieces", piece_elements(map)}});
}

std::vector<WebResource> page_in_parts(const std::string& title, const std::string& scene, const fs::path& library) {
    std::vector<Module> scripts = modules(library);
    const auto url = [](const Module& module) { return "./scripts/" + module.file; };
    std::vector<WebResource> resources;
    resources.push_back(
        {"", "text/html; charset=utf-8",
         fill(asset(kHtml), {{"policy", kServedPolicy},
                             {"title", escaped(title)},
                             {"style", "<link rel=\"stylesheet\" href=\"" + std::string(kStyle) + "\">"},
                             {"imports", import_map(scripts, url)},
                             {"scene", script_json(scene)},
                             {"pieces", ""}})});
    resources.push_back({std::string(kStyle), "text/css; charset=utf-8", std::string(asset(kStyle))});
    for (Module& module : scripts)
        resources.push_back({"scripts/" + module.file, "text/javascript; charset=utf-8", std::move(module.text)});
    return resources;
}

std::vector<WebResource> served_page(const WebScene& scene, const fs::path& library) {
    EncodedMap map = encode_map(scene.surfels);
    const SceneUrls urls{[](std::size_t i) { return "map/" + std::to_string(i); },
                         [](std::size_t i) { return "keyframes/" + std::to_string(i) + ".jpg"; }};
    std::vector<WebResource> resources = page_in_parts(scene.title, scene_json(scene, map, urls), library);
    for (std::size_t i = 0; i < map.pieces.size(); ++i)
        resources.push_back({urls.piece(i), "application/octet-stream", std::move(map.pieces[i].bytes)});
    for (std::size_t i = 0; i < scene.keyframes.size(); ++i)
        if (!scene.keyframes[i].jpeg.empty())
            resources.push_back({urls.image(i), "image/jpeg", scene.keyframes[i].jpeg});
    return resources;
}

}  // namespace posefusion
