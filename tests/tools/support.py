"""What the tests of the tools share."""
import sys
import tempfile
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"


def load(tool):
    """A tool as a module, for its functions."""
    loader = SourceFileLoader(tool, str(TOOLS / tool))
    module = module_from_spec(spec_from_loader(tool, loader))
    loader.exec_module(module)
    return module


def write_program(file, text):
    """A Python program that stands in for a real one; its first line is #!{python}, other braces are doubled."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text.format(python=sys.executable))
    file.chmod(0o755)


class ProgramFolder(unittest.TestCase):
    """A folder with programs that stand in for real ones, by their place."""

    programs = {}

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        for place, text in self.programs.items():
            write_program(self.root / place, text)

    def tearDown(self):
        self.folder.cleanup()
