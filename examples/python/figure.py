"""A figure in a file, where matplotlib is there; without it the examples print their numbers alone."""

from contextlib import contextmanager


class Nothing:
    """Takes every call."""

    def __getattr__(self, name):
        return lambda *values, **options: None


@contextmanager
def figure(path, x, y):
    try:
        import matplotlib
    except ImportError:
        yield Nothing()
        return
    matplotlib.use("Agg")  # files, no window
    from matplotlib import pyplot

    page, axes = pyplot.subplots()
    yield axes
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    page.savefig(path)
    pyplot.close(page)
    print("figure in", path)
