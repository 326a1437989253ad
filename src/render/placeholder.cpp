namespace tarn { int room_render; }
