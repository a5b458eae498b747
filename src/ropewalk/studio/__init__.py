"""The studio: a page in the browser, served from this machine, on which structures are seen, dragged and run.

`server` serves it to this machine only; `worker` computes in processes of their own, with limits. Nothing is imported
here: the command line looks at `command` for its help.
"""
