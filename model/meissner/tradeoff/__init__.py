"""``meissner tradeoff``: what accuracy costs, measured point by point; ``meissner choose``: the configuration
on that front which meets what is asked for.

axis       what an axis is, and one point of it
axes       a module per subject; nothing lists them
table      finds them
pool       points to processes, of this machine or of Dask
store      finished points on disk
sweep      from axes to results
pareto     which points no other one beats
draw, page pictures and report
needs      what is asked for, and the shipped configurations' own
choose     from needs to a configuration
"""
