# %% [markdown]
# # Compare families
#
# All patterns that come with the code, side by side. Stacking puts datasets on a new axis; it
# refuses those on other grids, and fills nothing in.

# %%
from pathlib import Path

import flexscale as fs
from flexscale.findings.table import all_findings, findings_text

here = Path.cwd()
results = next(p / "results" for p in (here, *here.parents) if (p / "results/reference").is_dir())
registry = fs.open_registry(results)
sweeps = registry.stack("pattern", kind="sweep", source="reference", native="joints")
fits = registry.stack("pattern", kind="fit", source="reference", native="joints")
tangents = registry.stack("pattern", kind="tangent", source="reference", native="joints")

# %% [markdown]
# Softest and stiffest direction of the flat sheet, and by how much they differ:

# %%
stiffness = tangents["stiffness"]
overview = stiffness.min("direction").to_dataframe("softest [N mm]")[["softest [N mm]"]]
overview["stiffest [N mm]"] = stiffness.max("direction").values
overview["ratio"] = overview["stiffest [N mm]"] / overview["softest [N mm]"]
overview.sort_values("ratio").round(2)

# %%
fs.plot.stiffness({p: tangents.sel(pattern=p) for p in ("hexagon", "square", "arrowhead")})

# %% [markdown]
# Which direction jams first, and at which curvature:

# %%
first = fits["fitted_value"].sel(parameter="kappa_0", side="closing")
jams = first.min("direction").to_dataframe("curvature [mm-1]")[["curvature [mm-1]"]]
jams["direction [degree]"] = first.idxmin("direction").values
jams.sort_values("curvature [mm-1]").round(4)

# %% [markdown]
# Closing against opening, at one curvature, in the middle over directions:

# %%
moment = sweeps["moment"].sel(curvature=0.02)
asymmetry = (moment.sel(side="closing") / moment.sel(side="opening")).median("direction")
asymmetry.to_dataframe("closing over opening")[["closing over opening"]].round(1)

# %% [markdown]
# What the paper says of patterns, held against these; `flexscale data findings` prints it with the
# numbers of each pattern.

# %%
findings = all_findings(registry, native="joints")
print(findings_text(findings, evidence=False))
