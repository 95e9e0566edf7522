class P:
    warnings=[]; attribute_names=set()
    def content(self): return b""
    def to_native(self, native):
        m=native.Material(); 
        import ctypes; m.struct_size=ctypes.sizeof(m); m.surface=-1
        return m, None
def translate(block, kind, resources): return P()
