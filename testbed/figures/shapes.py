"""Mode shapes along the beam."""

from collections.abc import Sequence

from matplotlib.axes import Axes

from models.arrays import FloatArray


def plot_shape(ax: Axes, x: FloatArray, shape: FloatArray, sleeves: Sequence[tuple[float, bool]], title: str) -> None:
    """One mode shape, with the sleeves that touch filled and the others hollow.

    Args:
        ax: to draw on.
        x: (n,) m from the clamp.
        shape: (n,) displacement, any scale.
        sleeves: position in m, and whether it touches.
        title: above the axes.
    """
    ax.axhline(0.0, color="0.8", linewidth=0.8)
    ax.plot(x, shape, color="tab:blue", linewidth=1.2)
    for position, touches in sleeves:
        fill, label = ("full", "sleeve that touches at rest") if touches else ("none", "sleeve open at rest")
        ax.plot([position], [0.0], linestyle="none", marker="^", color="tab:red", fillstyle=fill, label=label)
    ax.set_title(title, fontsize=9)
