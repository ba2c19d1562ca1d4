# %% [markdown]
# # From pattern to macro sheet
#
# A pattern, the macro model that was fitted to its native samples, and a finite sheet of that
# model, bent between two end strips.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import flexscale as fs

here = Path.cwd()
results = next(p / "results" for p in (here, *here.parents) if (p / "results/reference").is_dir())
registry = fs.open_registry(results)
pattern = fs.named_pattern("hexagon")
print(pattern)

# %% [markdown]
# The stored fit of this pattern. To make one: `fs.fit(fs.sweep(pattern, …))`, some minutes.

# %%
stored = registry.one(kind="fit", pattern="hexagon", source="reference")
model = fs.MacroModel.from_dataset(stored)
print(model)

# %%
fs.plot.macro_polar(
    stored, registry.one(kind="sweep", pattern="hexagon", source="reference"), sides="closing"
)

# %% [markdown]
# A sheet of 100 x 50 mm, closed to 0.012 /mm in the pattern's direction of 0°. Its free edges give
# way, so that it stores less than the law, which is that of an infinite sheet.

# %%
length, width, curvature = 100.0, 50.0, 0.012
options = fs.SheetOptions(size=12.0)
sheet = fs.simulate_sheet(
    model, length=length, width=width, curvature=curvature, direction=0.0, options=options
)
law = float(model.energy(curvature, 0.0))
print(f"{sheet.status.name} after {sheet.iterations} iterations")
print(f"energy density {sheet.energy_density:.4f} N/mm, of the law {law:.4f} N/mm")

# %%
figure = plt.figure(figsize=(5, 3))
axes = figure.add_subplot(projection="3d")
x, y, z = sheet.positions.T
axes.plot_trisurf(x, y, z, triangles=sheet.mesh.triangles, color="#D55E00", edgecolor="0.3")
axes.set_aspect("equal")
axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
