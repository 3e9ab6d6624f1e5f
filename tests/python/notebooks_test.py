#!/usr/bin/env python3
"""The notebooks of examples/notebooks run from top to bottom in their own folder, and draw what they say.

With nbclient and a kernel of Python they run as in Jupyter; the pictures of each are kept where MBK_PICTURES names a
folder, to be looked at.
"""

import base64
import os
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

try:
    import nbclient
    import nbformat
except ImportError:
    print("not here: nbclient; Debian has python3-nbclient and python3-ipykernel")
    sys.exit(77)

NOTEBOOKS = pathlib.Path(__file__).resolve().parents[2] / "examples/notebooks"


def executed(path, folder):
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    nbclient.NotebookClient(book, timeout=240, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
    return book


class Notebooks(unittest.TestCase):
    def check(self, path):
        with tempfile.TemporaryDirectory(prefix="mbk-notebook-") as name:
            for folder in ("notebooks", "teleop"):  # copies, because the notebooks write files beside themselves
                shutil.copytree(NOTEBOOKS.parent / folder, pathlib.Path(name, folder))
            book = executed(path, pathlib.Path(name, "notebooks"))
        pictures = tables = 0
        for number, cell in enumerate(book.cells):
            if cell.cell_type == "code":
                self.assertTrue(cell.source.strip(), f"cell {number} is empty")
            for output in cell.get("outputs", []):
                self.assertNotEqual(output.output_type, "error", output)
                if output.get("name") == "stderr":
                    self.assertNotRegex(output.text, r"Traceback|DeprecationWarning", f"cell {number}")
                data = output.get("data", {})
                if "image/png" in data:
                    pictures += 1
                    picture = base64.b64decode(data["image/png"])
                    self.assertGreater(len(picture), 4000, f"cell {number} draws next to nothing")
                    if os.environ.get("MBK_PICTURES"):
                        target = pathlib.Path(os.environ["MBK_PICTURES"])
                        target.mkdir(parents=True, exist_ok=True)
                        (target / f"{path.stem}-{pictures}.png").write_bytes(picture)
                tables += "<table" in data.get("text/html", "")
        self.assertGreaterEqual(pictures, 2)
        self.assertGreaterEqual(tables, 1)

    def test_there_are_three_without_stored_outputs(self):
        paths = sorted(NOTEBOOKS.glob("*.ipynb"))
        self.assertEqual(len(paths), 3)
        for path in paths:
            book = nbformat.read(path, as_version=4)
            self.assertFalse([cell for cell in book.cells if cell.get("outputs")], path)
            self.assertFalse(re.search(r"/(work|home|tmp)/", path.read_text(encoding="utf-8")), path)


for one in sorted(NOTEBOOKS.glob("*.ipynb")):
    setattr(Notebooks, f"test_{one.stem}", lambda self, path=one: self.check(path))


if __name__ == "__main__":
    unittest.main()
