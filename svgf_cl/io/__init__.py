"""Files in and out: frames, pictures, what is kept on this machine."""
