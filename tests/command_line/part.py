#!/usr/bin/env python3
"""Writes a character with some of its muscles and bones, which takes a third of the time to compile.   Usage: part.py WHOLE PART"""
import os
import sys
import types

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inputs import write_part  # noqa: E402

if __name__ == "__main__":
    write_part(types.SimpleNamespace(path=lambda name: name), sys.argv[1], sys.argv[2])
