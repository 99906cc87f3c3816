#!/usr/bin/env python3
"""Makes data/body/survey_male.csv and survey_female.csv from the public rows of ANSUR II (python3, standard library only).

    python3 data/make_survey.py FOLDER        folder that holds ANSUR_II_MALE_Public.csv and ANSUR_II_FEMALE_Public.csv

Source: 2012 Anthropometric Survey of U.S. Army Personnel, Gordon et al. 2014, NATICK/TR-15/007; a work of the US Government.
Only statistics are written, no person's row: mean, standard deviation and correlations of the fields that data/body/measures.csv
names, from every second person in the file's order (the first, third, fifth ...). The others are left for judging predictions.
Lengths in metres, weight in kilograms (the file's millimetres and tenths of kilograms). Correlations to four digits.
"""
import csv
import math
import pathlib
import sys


def fields(table):
    with open(table, encoding="utf-8", newline="") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        return list(dict.fromkeys(row["ansur"] for row in rows if row["ansur"]))


def people(file, names):
    with open(file, encoding="latin-1", newline="") as lines:
        rows = [{key.lower(): value for key, value in row.items()} for row in csv.DictReader(lines)]
    return [[float(row[name]) * (0.1 if name == "weightkg" else 0.001) for name in names] for row in rows[::2]]


def write(file, names, rows):
    n = len(rows)
    columns = list(zip(*rows))
    means = [sum(column) / n for column in columns]
    apart = [[value - mean for value in column] for column, mean in zip(columns, means)]
    sds = [math.sqrt(sum(value * value for value in column) / (n - 1)) for column in apart]
    with open(file, "w", encoding="utf-8") as out:
        out.write(f"# Statistics of {n} people of ANSUR II (Gordon et al. 2014, NATICK/TR-15/007), made by data/make_survey.py from every second row.\n")
        out.write("# mean and sd in metres (weight: kilograms); then the correlation with each field.\n")
        out.write(",".join(["field", "mean", "sd", *names]) + "\n")
        for i, name in enumerate(names):
            row = [sum(a * b for a, b in zip(apart[i], apart[j])) / ((n - 1) * sds[i] * sds[j]) for j in range(len(names))]
            out.write(",".join([name, f"{means[i]:.5f}", f"{sds[i]:.5f}", *(f"{value:.4f}" for value in row)]) + "\n")


def main():
    source = pathlib.Path(sys.argv[1])
    body = pathlib.Path(__file__).resolve().parent / "body"
    names = fields(body / "measures.csv")
    for sex in ("male", "female"):
        write(body / f"survey_{sex}.csv", names, people(source / f"ANSUR_II_{sex.upper()}_Public.csv", names))


main()
