#pragma once
#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <stdexcept>
#include <string>

namespace posefusion::test {

/// Numbers of the C library and of C++ streams are written as in Germany, "1.234,5", while it lives. Where the system
/// lacks the locale it is made in a folder for the process, of what the package `locales` brings.
class GermanLocale {
public:
    explicit GermanLocale(const std::filesystem::path& folder) {
        const std::string made = (folder / kName).string();
        if (std::setlocale(LC_ALL, kName) == nullptr &&
            std::system(("localedef -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1").c_str()) == 0) {
            ::setenv("LOCPATH", folder.c_str(), 1);
            made_ = true;
        }
        try {
            std::locale::global(std::locale(kName));  // sets that of C, too
            there_ = true;
        } catch (const std::runtime_error&) {
        }
    }
    ~GermanLocale() {
        std::locale::global(std::locale::classic());
        if (made_) ::unsetenv("LOCPATH");
    }
    GermanLocale(const GermanLocale&) = delete;
    GermanLocale& operator=(const GermanLocale&) = delete;

    /// false: the system has neither the locale nor what it is made of.
    [[nodiscard]] bool there() const { return there_; }

private:
    static constexpr const char* kName = "de_DE.UTF-8";
    bool made_ = false, there_ = false;
};

}  // namespace posefusion::test
