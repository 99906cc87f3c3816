#!/usr/bin/env python3
"""Makes the picture of docs/studio.md by its script of actions.

    studio.py ECORCHE
"""
import os
import subprocess
import sys
import tempfile

from make import HERE, convert


def main():
    program = os.path.abspath(sys.argv[1])
    script = os.path.join(HERE, "..", "studio", "plate.txt")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "studio", "--script", os.path.abspath(script)], cwd=folder, check=True)
        convert(os.path.join(folder, "studio.png"), os.path.join(HERE, "studio.jpg"), 760)


if __name__ == "__main__":
    main()
