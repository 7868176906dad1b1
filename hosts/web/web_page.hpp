#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "hosts/web/scene.hpp"

/// A page that shows a map, the path of the camera and its keyframes in any browser with WebGL 2. It loads nothing from
/// elsewhere, and tells the browser to see to that (Content-Security-Policy).
namespace posefusion {

/// One file with everything in it, which opens without a network. Throws Error: three.js is not where tools/setup or
/// the installation puts it. @param library  folder of three.js; empty = there
[[nodiscard]] std::string self_contained_page(const WebScene& scene, const std::filesystem::path& library = {});

/// What a server has to offer.
struct WebResource {
    std::string path;  ///< relative to the page, which has the empty one
    std::string type;  ///< MIME
    std::string body;
};

/// The same page in parts that are loaded one after the other: the page first, then the map piece by piece.
[[nodiscard]] std::vector<WebResource> served_page(const WebScene& scene, const std::filesystem::path& library = {});

/// The page with its scripts alone. @param scene  JSON of what it shows, which says where the rest is to be had
[[nodiscard]] std::vector<WebResource> page_in_parts(const std::string& title, const std::string& scene,
                                                     const std::filesystem::path& library = {});

}  // namespace posefusion
