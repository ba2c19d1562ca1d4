"""Steps: typed parameters and one pure function each; the only writers of datasets.

An experiment file (`experiment`) becomes a plan of jobs (`plan`), which the workflow engine
(`engine`, workflows/Snakefile) runs one process each (`worker`).
"""
