"""Plant and identifier stepped together by several importers, whose trajectories must be equal.

All of them exchange values first and step then: the identifier's inputs at t are the plant's outputs at t. So two
importers agree to the last digit, or one of them does something else to an FMU.
"""
