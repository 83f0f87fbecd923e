# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a recording as a table of pandas and says which module was pressed most. Usage: read_dataframe.py FILE.mcap"""
import sys

import triskin

recording = triskin.read(sys.argv[1])
table = recording.to_dataframe()
taxels = [name for name in table if name.startswith("change_counts_")]
table["strongest"] = table[taxels].max(axis=1)
by_module = table.groupby("number")["strongest"].max().sort_values(ascending=False)
print(table[["time_s", "number", "strongest"]].describe())
print(f"most pressed: module {by_module.index[0]} with {by_module.iloc[0]:.0f} counts")
