namespace tarn { int room_scene; }
