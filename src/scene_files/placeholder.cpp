namespace tarn { int room_scene_files; }
