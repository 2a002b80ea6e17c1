"""``meissner tradeoff``: the cost of accuracy, measured point by point; ``meissner choose``: a configuration
on that front that meets given needs.

axis       definition of an axis and its points
axes       a module per subject; no list of them exists
table      finds the modules of axes
worker     measures points, in processes of this machine or on the workers of Dask
store      finished points on disk
sweep      from axes to results
pareto     points that no other point dominates
draw, page pictures and report
needs      needs of a user, and those of the shipped configurations
choose     from needs to a configuration
"""
