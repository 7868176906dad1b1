#include "hosts/web/web_page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tests/hosts/web/random_map.hpp"

/// The page as text; how it looks and what it does in a browser is tested by page_test.py.
namespace posefusion::test {
namespace {

class WebPage : public ::testing::Test {
protected:
    WebPage() {
        temp_.write("three.module.min.js", "import{a}from\"./three.core.min.js\";export{b}from\"./three.core.min.js\"");
        temp_.write("three.core.min.js", "export const core = 1;");
        temp_.write("OrbitControls.js", "import {x} from 'three';");
        scene_ = make_scene("kitchen", random_map(100'000), nullptr);
        scene_.poses.push_back({});
        scene_.keyframes = {{0, "JPEG"}, {0, ""}};
    }
    static nlohmann::json json_of(const std::string& page, const std::string& begin) {
        const std::size_t at = page.find(begin) + begin.size();
        return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
    }
    static nlohmann::json scene_in(const std::string& page) {
        return json_of(page, "<script type=\"application/json\" id=\"scene\">");
    }
    TempFolder temp_;
    WebScene scene_;
};

TEST_F(WebPage, AsOneFileNamesNothingOutside) {
    const std::string page = self_contained_page(scene_, temp_.path());
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
    EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(?!data:)")));
    for (const auto& [name, url] : json_of(page, "<script type=\"importmap\">").at("imports").items())
        EXPECT_TRUE(url.get<std::string>().starts_with("data:text/javascript;base64,")) << name;
    const nlohmann::json scene = scene_in(page);
    EXPECT_EQ(scene.at("title"), "kitchen");
    EXPECT_EQ(scene.at("keyframes")[0].at("image"), "data:image/jpeg;base64,SlBFRw==");
    EXPECT_TRUE(scene.at("keyframes")[1].at("image").is_null());
    for (const auto& piece : scene.at("map").at("pieces")) {
        const std::string id = piece.at("url").get<std::string>().substr(1);
        EXPECT_NE(page.find("<script type=\"text/plain\" id=\"" + id + "\">"), std::string::npos);
    }
}

TEST_F(WebPage, FromAServerNamesWhatTheServerHas) {
    const auto resources = served_page(scene_, temp_.path());
    std::set<std::string> paths;
    for (const WebResource& r : resources) EXPECT_TRUE(paths.insert(r.path).second) << r.path << " is there twice";
    EXPECT_EQ(resources.front().path, "");
    const std::string& page = resources.front().body;
    for (const auto& [name, url] : json_of(page, "<script type=\"importmap\">").at("imports").items())
        EXPECT_TRUE(paths.contains(url.get<std::string>().substr(2))) << url;
    const nlohmann::json scene = scene_in(page);
    for (const auto& piece : scene.at("map").at("pieces")) EXPECT_TRUE(paths.contains(piece.at("url")));
    EXPECT_TRUE(paths.contains(scene.at("keyframes")[0].at("image")));
    EXPECT_TRUE(paths.contains("style.css"));
}

TEST_F(WebPage, ModulesImportEachOtherByName) {
    const auto resources = served_page(scene_, temp_.path());
    const nlohmann::json imports = json_of(resources.front().body, "<script type=\"importmap\">").at("imports");
    const std::regex from("from ?['\"]([\\w./-]+)['\"]");
    int modules = 0;
    for (const WebResource& r : resources) {
        if (!r.type.starts_with("text/javascript")) continue;
        ++modules;
        for (std::sregex_iterator i(r.body.begin(), r.body.end(), from), end; i != end; ++i)
            EXPECT_TRUE(imports.contains((*i)[1].str())) << r.path << " imports " << (*i)[1];
    }
    EXPECT_GT(modules, 10);
}

TEST_F(WebPage, NamesCannotBecomeMarkup) {
    scene_.title = "</title></script><script>alert('x')</script>&\"";
    scene_.facts = {{"<b>", "<!--"}};
    const std::string page = self_contained_page(scene_, temp_.path());
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    EXPECT_EQ(scene_in(page).at("title"), scene_.title);
}

TEST_F(WebPage, WithoutItsLibrarySaysWhatToDo) {
    std::filesystem::remove(temp_ / "three.core.min.js");
    const std::string fault = message_of<Error>([&] { (void)self_contained_page(scene_, temp_.path()); });
    EXPECT_NE(fault.find("three.core.min.js"), std::string::npos) << fault;
    EXPECT_NE(fault.find("tools/setup"), std::string::npos) << fault;
}

}  // namespace
}  // namespace posefusion::test
