#!/usr/bin/env python3
"""Nothing in the parts that become a library parses or prints a number in a way that follows the locale of the process;
see engine/core/number_text.hpp. Usage: source_test.py SOURCE_FOLDER"""
import re
import sys
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1))
A_FRACTION = r"(scale|\w+_(max|min|speed|seconds|rmse)|fps|metres|confidence|radius)"  # by its name
FOLLOWS_THE_LOCALE = {
    r"\b(std::)?(strto(f|d|ld)|atof|sto(f|d|ld))\s*\(": "number_of()",
    r"printf\s*\([^;]*%[-+ #0]*[\d.*]*[aefgAEFG]": "fixed_text(), shortest_text() or fmt::format()",
    r"\b(std::)?o?stringstream\b|\bsetprecision\b": "std::string and shortest_text()",
    rf"\bstd::to_string\([^():]*\b{A_FRACTION}\)": "shortest_text()",
}


class Sources(unittest.TestCase):
    def test_follow_no_locale(self):
        parts = ("hosts", "pose", "segmentation", "engine")
        files = [file for part in parts for file in (SOURCE / part).rglob("*.[ch]pp")]
        self.assertGreater(len(files), 200)
        for file in files:
            text = re.sub(r"//[^\n]*", "", file.read_text())
            for pattern, instead in FOLLOWS_THE_LOCALE.items():
                for found in re.finditer(pattern, text):
                    line = text.count("\n", 0, found.start()) + 1
                    self.fail(f"{file}:{line}: '{found[0]}' follows the locale; use {instead}")

    def test_patterns_find_what_they_should(self):
        for code in (
            "strtod(a, b)",
            "std::stof(text)",
            'std::snprintf(t, n, "%.3f", x)',
            'printf("%d %g", i, x)',
            "std::ostringstream s;",
            "std::to_string(config.scale)",
        ):
            self.assertTrue(any(re.search(pattern, code) for pattern in FOLLOWS_THE_LOCALE), code)
        for code in (
            "std::stoul(text)",
            'std::printf("%zu %s", n, s)',
            "std::to_string(count)",
            "std::istringstream words(line);",
        ):
            self.assertFalse(any(re.search(pattern, code) for pattern in FOLLOWS_THE_LOCALE), code)


if __name__ == "__main__":
    unittest.main()
