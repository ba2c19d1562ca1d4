# %% [markdown]
# # Explore a sweep
#
# A sweep holds the bending response of one pattern: moments and energies by side, direction and
# curvature. This notebook reads the ones that come with the code; nothing is solved.

# %%
from pathlib import Path

import flexscale as fs

here = Path.cwd()
results = next(p / "results" for p in (here, *here.parents) if (p / "results/reference").is_dir())
registry = fs.open_registry(results)
registry.table(kind="sweep")

# %% [markdown]
# One dataset, with units on every variable and axis:

# %%
sweep = registry.one(kind="sweep", pattern="brick", source="reference")
print(sweep["moment"])

# %% [markdown]
# Values by what they mean. `sample` takes the nearest stored one, and says which that was; it
# refuses what lies between samples.

# %%
along = sweep.fs.sample("moment", side="closing", direction=0, curvature=0.015)
across = sweep.fs.sample("moment", side="closing", direction=90, curvature=0.015)
print(along.attrs["sampled"])
print(f"{float(along):.2f} N along the courses, {float(across):.2f} N across")

# %%
fs.plot.polar(sweep, side=["closing", "opening"])

# %%
fs.plot.curves(sweep, directions=[0, 45, 90])

# %% [markdown]
# Where do scales touch, and is it sudden? Not converged samples would be NaN here, and crosses in
# the plots.

# %%
unconverged = int((sweep["status"] != 0).sum())
onset = fs.contact_onset(sweep).sel(side="closing")
print(f"{unconverged} samples did not converge")
onset[["free_until", "touches_from", "onset_spread"]].to_dataframe().round(4)

# %% [markdown]
# How much of the energy is in the joints, and how much in the contact?

# %%
energy = sweep.sel(side="closing", direction=0, curvature=[0.004, 0.03])
parts = {
    part: (energy[f"energy_density_{part}"] / energy["energy_density"]).values.round(3)
    for part in ("joints", "contact")
}
print(parts)

# %% [markdown]
# Where the numbers come from:

# %%
registry.lineage(registry.find(kind="fit", pattern="brick", source="reference").one().id)
