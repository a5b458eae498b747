"""One mechanical system: cable runs, joints and supports, contacts and bodies, moved by one loop."""
