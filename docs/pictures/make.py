#!/usr/bin/env python3
"""Makes the pictures of README.md and docs/tour.md from what `make demo` has written.

    make.py DEMO_FOLDER
"""
import base64
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
# Words that the captions begin with in the report, and the width in pixels.
SHEETS = {"fit.jpg": ("From the template to the athlete", 1100), "ecorche.jpg": ("The muscles that are seen largest", 1400), "jump.jpg": ("Run-up, take-off, flight and landing", 1520)}
FILM_SHARE = 0.64  # of the film's length: in flight


def pictures_of(page):
    """(caption, PNG) of each picture of a report page."""
    found = re.findall(r'<img[^>]*src="data:image/png;base64,([^"]+)"[^>]*>\s*(?:<figcaption>(.*?)</figcaption>)?', page, re.S)
    return [(re.sub(r"<[^>]+>", "", caption), base64.b64decode(data)) for data, caption in found]


def convert(source, target, width, before=()):
    subprocess.run(["ffmpeg", "-y", "-loglevel", "error", *before, "-i", source, "-frames:v", "1", "-vf", f"scale={width}:-2:flags=area", "-q:v", "4", "-bitexact", target], check=True)


def program_in(folder, program):
    """Two functions: the path of a name in the folder; a run of the program, which may miss targets."""

    def path(name):
        return os.path.join(folder, name)

    def ecorche(*words):
        done = subprocess.run([program, *words], capture_output=True, text=True)
        if done.returncode not in (0, 8):
            raise SystemExit(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr}")

    return path, ecorche


def main():
    folder = sys.argv[1]
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as page:
        pictures = pictures_of(page.read())
    for name, (begin, width) in SHEETS.items():
        found = [png for caption, png in pictures if caption.startswith(begin)]
        if len(found) != 1:
            raise SystemExit(f"{name}: {len(found)} pictures of the report begin with '{begin}'; there are:\n  " + "\n  ".join(caption[:80] for caption, _ in pictures))
        with tempfile.NamedTemporaryFile(suffix=".png") as sheet:
            sheet.write(found[0])
            sheet.flush()
            convert(sheet.name, os.path.join(HERE, name), width)
    film = os.path.join(folder, "long-jump.mp4")
    length = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0", film], capture_output=True, text=True, check=True).stdout
    convert(film, os.path.join(HERE, "long-jump.jpg"), 960, ["-ss", f"{FILM_SHARE * float(length):.3f}"])


if __name__ == "__main__":
    main()
