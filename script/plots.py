"""Shared by the scripts that draw the manual's pictures."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import PIL.Image

COLORS = ["tab:blue", "tab:cyan", "tab:green", "tab:olive", "tab:orange", "tab:red", "tab:purple", "tab:brown", "k", "tab:pink",
          "tab:gray", "gold"]
MARKERS = "os^Dv<>phX*P"


def curve(number):
    """The style of a curve: thin, its points hollow."""
    return {"marker": MARKERS[number % len(MARKERS)], "markersize": 4, "markerfacecolor": "none", "linewidth": 1,
            "color": COLORS[number % len(COLORS)]}


def beside(axes):
    """The legend at the right of the axes."""
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)


def save(figure, path, colors=128):
    figure.tight_layout()
    image = io.BytesIO()
    figure.savefig(image, format="png", metadata={"Software": None})
    plt.close(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    PIL.Image.open(image).convert("RGB").quantize(colors).save(path, optimize=True)
