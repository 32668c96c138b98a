"""An embedded ROS 1 master: naming, registration and the parameter server, for systems without ROS installed.

`core` decides (no sockets), `params` holds the parameters, `server` serves them on the loop of
`roslet.io.select`. Imports io, engine, wire, names, errors, record.
"""
